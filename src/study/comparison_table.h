// A comparison of candidates as tables.
#pragma once

#include <cstddef>
#include <string>

#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// comparison.csv: a row for each metric and pair of candidates, then one for the failures of each
/// pair (`metric` is "failure"), then the average ranks; numbers have 17 digits, cells that do not
/// apply are empty.
std::string comparison_csv(const CandidateComparison& comparison);

/// comparison_by_key.csv: a row for each metric, pair of candidates, varied key and value (or
/// neighbouring values) of it.
std::string by_key_csv(const CandidateComparison& comparison);

/// A p value: "0.012", behind `equals`; one that is all rounding is "< 1e-15".
std::string p_text(double p, const std::string& equals = "");

/// "peak_N, a beside b: the sign turns with k (p = 0.001): -1 at 2, 3 at 4".
std::string turns_text(const CandidateComparison& comparison, const KeyInteraction& one);

/// Why nothing can be shown, where the verdict of a metric is that there are too few blocks; else
/// empty.
std::string few_text(const CandidateComparison& comparison);
/// The same of so many blocks, which are too few, and pairs of runs in them.
std::string few_text(std::size_t blocks, std::size_t pairs);

/// "In 18 blocks b has 2 different runs: …": what a reader must know where the same
/// runs come again. Empty if none does.
std::string repeated_text(const CandidateComparison& comparison);

/// "No run of b has settling_s; …": what a reader must know where a row is missing. Empty if
/// none is.
std::string never_text(const CandidateComparison& comparison);

/// The same for people, in short.
std::string comparison_text(const CandidateComparison& comparison, std::size_t width);

}  // namespace breakwater
