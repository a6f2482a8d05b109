// Tables of a comparison of candidates.
#pragma once

#include <cstddef>
#include <string>

#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// comparison.csv: a row per metric and pair of candidates, then a row for the failures of each
/// pair (`metric` is "failure"). Numbers have 17 digits. Cells that do not apply are empty.
std::string comparison_csv(const CandidateComparison& comparison);

/// comparison_by_key.csv: a row per metric, pair of candidates, varied key and value (or group of
/// neighbouring values).
std::string by_key_csv(const CandidateComparison& comparison);

/// "3 [2.1, 3.8]": a value with its interval.
std::string brief(const EstimatedMedian& median);

/// A p value behind `equals`, such as "0.012". Below the rounding error it is "< 1e-15".
std::string p_text(double p, const std::string& equals = "");

/// A line such as "peak_N, a beside b: the sign turns with k (p = 0.001): -1 at 2, 3 at 4".
std::string turns_text(const CandidateComparison& comparison, const KeyInteraction& one);

/// The smallest number of blocks, from `blocks` on, in which one of so many tests can be
/// significant.
std::size_t blocks_for_verdict(std::size_t blocks, std::size_t tests);

/// The reason for the verdict "too few blocks". Empty if no metric has this verdict.
std::string few_text(const CandidateComparison& comparison);
/// The same from the numbers of blocks, of pairs of runs in them and of tests, and from the
/// smallest p that these can give. `fewer` is a way to have fewer tests.
inline constexpr const char* kFewerMetrics = "fewer metrics (compare.metrics)";
std::string few_text(std::size_t blocks, std::size_t pairs, std::size_t tests, double least_p,
                     const std::string& fewer = kFewerMetrics);

/// A note on repeated runs, such as "In 18 blocks b has 2 different runs: …". Empty if no run
/// repeats.
std::string repeated_text(const CandidateComparison& comparison);

/// A note on missing rows, such as "No run of b has settling_s; …". Empty if no row is missing.
std::string never_text(const CandidateComparison& comparison);

/// A short summary of the comparison for readers.
std::string comparison_text(const CandidateComparison& comparison, std::size_t width);

}  // namespace breakwater
