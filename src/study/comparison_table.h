// Tables of a comparison of candidates.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/study/result_row.h>

namespace breakwater {

/// The rows of comparison.csv: one per metric and pair of candidates, then a row for the failures
/// of each pair (`metric` is "failure"). Numbers have 17 digits. Cells that do not apply are empty.
/// Only those of `metric` (or kFailure), unless it is empty.
std::vector<ResultRow> comparison_rows(const CandidateComparison& comparison,
                                       const std::string& metric = "");

/// A p value, such as "0.012". Below the rounding error it is "< 1e-15".
std::string p_text(double p);

/// The smallest number of blocks, from `blocks` on, in which one of so many tests can be
/// significant.
std::size_t blocks_for_verdict(std::size_t blocks, std::size_t tests);

/// The reason for the verdict "too few blocks", from the numbers of blocks, pairs of runs and
/// tests. `least_p` is the smallest p that these can give, and `fewer` a way to have fewer tests.
inline constexpr const char* kFewerMetrics = "fewer metrics (compare.metrics)";
std::string few_text(std::size_t blocks, std::size_t pairs, std::size_t tests, double least_p,
                     const std::string& fewer = kFewerMetrics);

/// The columns and rows for readers, of one metric (or kFailure), or of all.
std::vector<std::vector<std::string>> comparison_table(const CandidateComparison& comparison,
                                                       const std::string& metric = "");

/// Sentences for readers of the table.
std::vector<std::string> comparison_notes(const CandidateComparison& comparison);

/// A short summary of the comparison for readers.
std::string comparison_text(const CandidateComparison& comparison, std::size_t width);

}  // namespace breakwater
