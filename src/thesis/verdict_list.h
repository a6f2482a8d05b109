// All verdicts of a reproduction as a table for other programs.
#pragma once

#include <string>

#include <breakwater/thesis/reproduction.h>

namespace breakwater {

/// A CSV file, one line for each entry of the page's tables, in their order: where it stands, what
/// was measured (the median or share over `runs`, smallest and largest with all digits; empty where
/// there is no number), what is printed or said, the verdict ("shown" where there is none) and,
/// where it does not come out, why.
std::string verdict_list(const Reproduction& reproduction, const Measured& measured);

}  // namespace breakwater
