// A comparison of candidates as tables.
#pragma once

#include <cstddef>
#include <string>

#include <breakwater/study/paired_comparison.h>

namespace breakwater {

/// comparison.csv: a row for each metric and pair of candidates, then one for the failures of each
/// pair (`metric` is "failure"), then the average ranks; numbers have 17 digits, cells that do not
/// apply are empty.
std::string comparison_csv(const CandidateComparison& comparison);

/// "In 18 worlds there are but 2 different runs of b, …": what a reader must know where the same
/// runs come again. Empty if none does.
std::string repeated_text(const CandidateComparison& comparison);

/// "Not one run of b has settling_s; …": what a reader must know where a row is missing. Empty if
/// none is.
std::string never_text(const CandidateComparison& comparison);

/// The same for people, in short.
std::string comparison_text(const CandidateComparison& comparison, std::size_t width);

}  // namespace breakwater
