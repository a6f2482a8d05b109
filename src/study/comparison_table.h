// Comparisons and rankings of candidates, as sentences, tables, rows of CSV files and JSON.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/statistics/ranking.h>
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

/// "tlsc-2N has the lowest peak_force_N: 5.4 N, 3 N below the next (hpfc-2N), 95 % 2.1 to 3.8 N, in
/// 8 of 8 conditions." or "No difference in peak_force_N is shown between …: about 14 conditions
/// would show 0.5 N.", and what the bounds leave out. A condition is a block.
std::string ranking_sentence(const Ranking& ranking);

/// A header, then a row for each candidate. `behind` is how much worse it is than the first.
std::vector<std::vector<std::string>> ranking_table(const Ranking& ranking);

/// The question, the sentence, the table, its numbers, and the comparison of each pair.
nlohmann::ordered_json ranking_json(const Ranking& ranking);

/// The sentence and the table for a terminal. The table has at most 20 lines. Long names are cut in
/// the middle.
std::string ranking_text(const Ranking& ranking, std::size_t width);

}  // namespace breakwater
