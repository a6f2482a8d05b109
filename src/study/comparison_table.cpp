#include <breakwater/study/comparison_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <ranges>
#include <utility>

#include <breakwater/config/names.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

// Printed columns: a head, and its column of comparison.csv. The first ones are labels.
constexpr std::size_t kLabels = 3;
constexpr std::pair<const char*, const char*> kPrinted[] = {{"metric", "metric"},
                                                            {"candidate", "candidate"},
                                                            {"reference", "reference"},
                                                            {"blocks", "blocks"},
                                                            {"pairs", "pairs"},
                                                            {"median", "median"},
                                                            {"difference (95 %)", "difference"},
                                                            {"p", "p_holm"},
                                                            {"better in", "probability_better"},
                                                            {"verdict", "verdict"}};

std::string repeated_text(const CandidateComparison& comparison) {
  std::vector<std::string> repeated;
  for (std::size_t c = 0; c < comparison.candidates.size(); ++c) {
    if (comparison.reached[c] == comparison.blocks) continue;
    repeated.push_back(
        fmt::format("{} has {} different runs", comparison.candidates[c], comparison.reached[c]));
  }
  if (repeated.empty()) return "";
  return fmt::format(
      "In {} blocks {}: some varied keys have no effect there. Equal pairs count once",
      comparison.blocks, fmt::join(repeated, ", "));
}

std::string never_text(const CandidateComparison& comparison) {
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < comparison.candidates.size(); ++c) {
    if (comparison.never[c].empty()) continue;
    parts.push_back(fmt::format("No run of {} has {}", comparison.candidates[c],
                                fmt::join(comparison.never[c], ", ")));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

// The goal min of a metric with a sign prefers its most negative value.
std::string signed_text(const CandidateComparison& comparison) {
  std::vector<std::string> metrics;
  for (const PairComparison& one : comparison.metrics) {
    const bool is_negative = std::min(one.median.value, one.reference_median.value) < 0.0;
    if (one.goal != Goal::min || !is_negative) continue;
    if (metrics.empty() || metrics.back() != one.metric) metrics.push_back(one.metric);
  }
  if (metrics.empty()) return "";
  return fmt::format(
      "Negative medians of {}: the goal min prefers the most negative value. For a small magnitude "
      "compare a metric without a sign, such as an rms or a peak",
      fmt::join(metrics, ", "));
}

}  // namespace

std::string p_text(double p) {
  return p < 1e-15 ? "< 1e-15" : fmt::format("{:.2g}", p);
}

std::vector<ResultRow> comparison_rows(const CandidateComparison& comparison,
                                       const std::string& metric) {
  std::vector<ResultRow> rows;
  for (const auto* comparisons : {&comparison.metrics, &comparison.failures}) {
    for (const PairComparison& one : *comparisons) {
      if (!metric.empty() && one.metric != metric) continue;
      ResultRow& row = rows.emplace_back();
      row.put("metric", one.metric);
      row.put("goal", one.goal == Goal::none ? "" : name_of(goal_names(), one.goal));
      row.put("candidate", comparison.candidates[one.candidate]);
      row.put("reference", comparison.candidates[one.reference]);
      row.put("pairs", std::to_string(one.pairs));
      row.put("median", one.median);
      row.put("reference_median", one.reference_median);
      row.put("difference", one.difference);
      row.put("p", one.p);
      row.put("p_holm", one.p_holm);
      row.put("probability_smaller", one.probability_smaller);
      row.put("probability_better", one.probability_better);
      row.put("verdict", name_of(one.verdict));
      const auto count = [&](const char* column, std::size_t number) {
        row.put(column, one.metric == kFailure ? std::to_string(number) : "");
      };
      count("failures", one.failures);
      count("reference_failures", one.reference_failures);
      count("failures_alone", one.larger);
      count("reference_failures_alone", one.smaller);
      row.put("blocks", std::to_string(one.blocks));
    }
  }
  return rows;
}

std::size_t blocks_for_verdict(std::size_t blocks, std::size_t tests) {
  while (least_p(blocks, std::max<std::size_t>(1, tests)) > kAlpha) ++blocks;
  return blocks;
}

std::string few_text(std::size_t blocks, std::size_t pairs, std::size_t tests, double least_p_holm,
                     const std::string& fewer) {
  std::string text = fmt::format(
      "Too few blocks: with {} blocks{} p cannot be below {:.4g}, and a verdict needs "
      "at least {}{}",
      blocks, tests > 1 ? fmt::format(" and {} tests (Holm's correction)", tests) : "",
      least_p_holm, blocks_for_verdict(blocks, tests),
      least_p(blocks) > kAlpha ? "" : ", or " + fewer);
  if (pairs > blocks) {
    text +=
        ". Random seeds repeat a block and do not count as blocks (worlds = \"seeds\" changes "
        "this)";
  }
  return text;
}

std::vector<std::vector<std::string>> comparison_table(const CandidateComparison& comparison,
                                                       const std::string& metric) {
  std::vector<std::vector<std::string>> table(1);
  for (const auto& [head, column] : kPrinted) table[0].emplace_back(head);
  for (const ResultRow& row : comparison_rows(comparison, metric)) {
    const std::string of = row.at("metric");
    std::vector<std::string>& cells = table.emplace_back();
    for (const std::string column : std::views::values(kPrinted)) {
      const auto p = column == "p_holm" ? number_in(row.at(column)) : std::nullopt;
      cells.push_back(cells.size() < kLabels                 ? row.at(column)
                      : p                                    ? p_text(*p)
                      : of == kFailure && column == "median" ? row.at("failures")
                                                             : row.shown(column));
      const bool is_fewer = row.at(column) != std::to_string(comparison.blocks);
      if (column == "blocks" && is_fewer) cells.back() += " *";
    }
  }
  return table;
}

std::vector<std::string> comparison_notes(const CandidateComparison& comparison) {
  std::vector<std::string> notes;
  const auto is_fewer = [&](const auto& one) { return one.blocks < comparison.blocks; };
  if (std::ranges::any_of(comparison.metrics, is_fewer) ||
      std::ranges::any_of(comparison.failures, is_fewer)) {
    notes.push_back(fmt::format(
        "* fewer than {} blocks: in the others a run failed or lacks the metric, or both "
        "runs equal those of another block",
        comparison.blocks));
  }
  const auto few = std::ranges::find(comparison.metrics, ComparisonVerdict::too_few_blocks,
                                     &PairComparison::verdict);
  if (few != comparison.metrics.end()) {
    notes.push_back(few_text(few->blocks, few->pairs, comparison.tests, few->least_p_holm));
  }
  for (const std::string& note :
       {repeated_text(comparison), never_text(comparison), signed_text(comparison)}) {
    if (!note.empty()) notes.push_back(note);
  }
  return notes;
}

std::string comparison_text(const CandidateComparison& comparison, std::size_t width) {
  std::string text = in_columns(comparison_table(comparison), width, kLabels);
  for (const std::string& note : comparison_notes(comparison)) {
    text += fmt::format("{}\n", fmt::join(wrapped(note, width), "\n"));
  }
  return text;
}

}  // namespace breakwater
