#include <breakwater/study/comparison_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include <breakwater/config/names.h>
#include <breakwater/record/csv.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

constexpr const char* kFailure = "failure";

std::string digits(double value) {
  return fmt::format("{:.17g}", value);
}

// A row, with access to its cells by column name.
class Row {
 public:
  void put(const std::string& column, const std::string& text) { cells_[column] = text; }
  void put(const std::string& column, double value) { put(column, digits(value)); }
  void put(const std::string& column, const EstimatedMedian& median) {
    put(column, median.value);
    if (!median.interval) return;
    put(column + "_lower", median.interval->lower);
    put(column + "_upper", median.interval->upper);
  }

  std::string print(const std::vector<std::string>& columns) const {
    std::vector<std::string> line;
    for (const std::string& column : columns) {
      const auto found = cells_.find(column);
      line.push_back(found == cells_.end() ? "" : found->second);
    }
    return csv_line(line);
  }

 private:
  std::map<std::string, std::string> cells_;
};

// The first cells of a pair's row.
template <typename Comparison>
Row begun_row(const CandidateComparison& comparison, const Comparison& one,
              const std::string& metric) {
  Row row;
  row.put("metric", metric);
  row.put("candidate", comparison.candidates[one.candidate]);
  row.put("reference", comparison.candidates[one.reference]);
  row.put("pairs", std::to_string(one.pairs));
  row.put("blocks", std::to_string(one.blocks));
  row.put("p", one.p);
  row.put("p_holm", one.p_holm);
  row.put("verdict", name_of(one.verdict));
  return row;
}

std::string percent(double share) {
  return fmt::format("{:.0f} %", 100.0 * share);
}

}  // namespace

std::string brief(const EstimatedMedian& median) {
  if (!median.interval) return in_digits(median.value);
  return fmt::format("{} [{}, {}]", in_digits(median.value), in_digits(median.interval->lower),
                     in_digits(median.interval->upper));
}

std::string p_text(double p, const std::string& equals) {
  return p < 1e-15 ? "< 1e-15" : fmt::format("{}{:.2g}", equals, p);
}

std::string comparison_csv(const CandidateComparison& comparison) {
  const std::vector<std::string> columns = {"metric",
                                            "goal",
                                            "candidate",
                                            "reference",
                                            "pairs",
                                            "median",
                                            "median_lower",
                                            "median_upper",
                                            "reference_median",
                                            "reference_median_lower",
                                            "reference_median_upper",
                                            "difference",
                                            "difference_lower",
                                            "difference_upper",
                                            "p",
                                            "p_holm",
                                            "probability_smaller",
                                            "probability_better",
                                            "verdict",
                                            "failures",
                                            "reference_failures",
                                            "failures_alone",
                                            "reference_failures_alone",
                                            "blocks",
                                            "variance_between_blocks",
                                            "variance_within_blocks",
                                            "sign_turns_with"};
  std::string text = csv_line(columns);
  for (const MetricComparison& one : comparison.metrics) {
    Row row = begun_row(comparison, one, one.metric);
    if (one.goal != Goal::none) row.put("goal", name_of(goal_names(), one.goal));
    row.put("median", one.median);
    row.put("reference_median", one.reference_median);
    row.put("difference", one.difference);
    row.put("probability_smaller", one.probability_smaller);
    if (one.probability_better) row.put("probability_better", *one.probability_better);
    if (one.between) {
      row.put("variance_between_blocks", *one.between);
      row.put("variance_within_blocks", 1.0 - *one.between);
    }
    row.put("sign_turns_with", fmt::format("{}", fmt::join(one.turns_with, "; ")));
    text += row.print(columns);
  }
  for (const FailureComparison& one : comparison.failures) {
    Row row = begun_row(comparison, one, kFailure);
    row.put("goal", name_of(goal_names(), Goal::min));
    row.put("failures", std::to_string(one.failures));
    row.put("reference_failures", std::to_string(one.reference_failures));
    row.put("failures_alone", std::to_string(one.alone));
    row.put("reference_failures_alone", std::to_string(one.reference_alone));
    text += row.print(columns);
  }
  return text;
}

std::string by_key_csv(const CandidateComparison& comparison) {
  std::string text =
      csv_line({"metric", "candidate", "reference", "key", "value", "repeats", "repeats_are",
                "difference", "difference_q10", "difference_q90", "p", "p_holm", "sign_turns"});
  for (const KeyInteraction& one : comparison.interactions) {
    for (const KeyInteraction::Value& value : one.values) {
      text += csv_line({one.metric, comparison.candidates[one.candidate],
                        comparison.candidates[one.reference], one.key, value.label,
                        std::to_string(value.repeats), one.is_of_worlds ? "seeds" : "blocks",
                        digits(value.median), digits(value.q10), digits(value.q90), digits(one.p),
                        digits(one.p_holm), one.turns ? "yes" : "not shown"});
    }
  }
  return text;
}

std::string turns_text(const CandidateComparison& comparison, const KeyInteraction& one) {
  std::vector<std::string> values;
  for (const KeyInteraction::Value& value : one.values) {
    values.push_back(fmt::format("{} at {}", in_digits(value.median), value.label));
  }
  return fmt::format("{}, {} beside {}: the sign turns with {} (p {}): {}", one.metric,
                     comparison.candidates[one.candidate], comparison.candidates[one.reference],
                     one.key, p_text(one.p_holm, "= "), fmt::join(values, ", "));
}

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

std::size_t blocks_for_verdict(std::size_t blocks, std::size_t tests) {
  const double alpha = ComparisonSettings{}.alpha;
  while (least_p(blocks, std::max<std::size_t>(1, tests)) > alpha) ++blocks;
  return blocks;
}

std::string few_text(const CandidateComparison& comparison) {
  const auto is_few = [](const auto& one) {
    return one.verdict == ComparisonVerdict::too_few_blocks;
  };
  const auto metric = std::find_if(comparison.metrics.begin(), comparison.metrics.end(), is_few);
  if (metric == comparison.metrics.end()) return "";
  return few_text(metric->blocks, metric->pairs, comparison.tests, metric->least_p_holm);
}

std::string few_text(std::size_t blocks, std::size_t pairs, std::size_t tests, double least_p_holm,
                     const std::string& fewer) {
  const double alpha = ComparisonSettings{}.alpha;
  std::string text = fmt::format(
      "Too few blocks: with {} blocks{} p cannot be below {:.4g}, and a verdict needs "
      "at least {}{}",
      blocks, tests > 1 ? fmt::format(" and {} tests (Holm's correction)", tests) : "",
      least_p_holm, blocks_for_verdict(blocks, tests),
      least_p(blocks) > alpha ? "" : ", or " + fewer);
  if (pairs > blocks) {
    text +=
        ". Random seeds repeat a block and do not count as blocks (worlds = \"seeds\" changes "
        "this)";
  }
  return text;
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
  for (const MetricComparison& one : comparison.metrics) {
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

std::string comparison_text(const CandidateComparison& comparison, std::size_t width) {
  const bool has_repeats = comparison.has_repeats();
  std::vector<std::string> header = {"metric", "candidate", "reference",
                                     "blocks", "median",    "difference (95 %)",
                                     "p",      "better in", "verdict"};
  if (has_repeats) header.insert(header.begin() + 4, {"pairs", "between"});
  constexpr std::size_t kLabels = 3;
  Table table(header, kLabels);
  bool has_mark = false;
  const auto begun = [&](const std::string& metric, const auto& one, const std::string& between) {
    const bool is_marked = one.blocks < comparison.blocks;
    has_mark = has_mark || is_marked;
    std::vector<std::string> row = {metric, comparison.candidates[one.candidate],
                                    comparison.candidates[one.reference],
                                    std::to_string(one.blocks) + (is_marked ? " *" : "")};
    if (has_repeats) row.insert(row.end(), {std::to_string(one.pairs), between});
    return row;
  };
  const auto add = [&](std::vector<std::string> row, const std::vector<std::string>& rest) {
    row.insert(row.end(), rest.begin(), rest.end());
    table.add(std::move(row));
  };
  for (const MetricComparison& one : comparison.metrics) {
    const bool has_goal = one.probability_better.has_value();
    add(begun(one.metric, one, one.between ? fmt::format("{:.3g} %", 100.0 * *one.between) : "-"),
        {in_digits(one.median.value), brief(one.difference), p_text(one.p_holm),
         has_goal ? percent(*one.probability_better) : "-",
         name_of(one.verdict) + (one.turns_with.empty() ? "" : " †")});
  }
  for (const FailureComparison& one : comparison.failures) {
    add(begun(kFailure, one, "-"),
        {std::to_string(one.failures),
         fmt::format("{:+d}",
                     static_cast<long>(one.failures) - static_cast<long>(one.reference_failures)),
         p_text(one.p_holm), "-", name_of(one.verdict)});
  }
  std::string text = table.print(width);
  const auto add_line = [&](const std::string& line) {
    if (!line.empty()) text += fmt::format("{}\n", fmt::join(wrapped(line, width), "\n"));
  };
  if (has_mark) {
    add_line(fmt::format(
        "* fewer than {} blocks: in the others a run failed or lacks the metric, or both "
        "runs equal those of another block",
        comparison.blocks));
  }
  if (has_repeats) {
    add_line(
        "between: share of the variance of the differences that is between blocks, not within "
        "them");
  }
  for (const KeyInteraction& one : comparison.interactions) {
    if (one.turns) add_line("† " + turns_text(comparison, one));
  }
  add_line(few_text(comparison));
  add_line(repeated_text(comparison));
  add_line(never_text(comparison));
  add_line(signed_text(comparison));
  return text;
}

}  // namespace breakwater
