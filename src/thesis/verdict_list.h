// All verdicts of a reproduction as a CSV table.
#pragma once

#include <string>

#include <breakwater/thesis/reproduction.h>

namespace breakwater {

/// A CSV text with a line for each entry of the page's tables, in their order. Columns: the
/// place; the measured median or share over `runs`; the smallest and largest value (all digits, or
/// empty); the printed result or statement. The verdict (or "shown") and the reason for a result
/// that is not reproduced follow.
std::string verdict_list(const Reproduction& reproduction, const Measured& measured);

/// The entries that are not reproduced, for a terminal: each if they are few, else their number by
/// section. Empty if there are none.
std::string failure_list(const Reproduction& reproduction, const Measured& measured);

}  // namespace breakwater
