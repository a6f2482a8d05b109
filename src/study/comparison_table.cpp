#include <breakwater/study/comparison_table.h>

#include <fmt/format.h>

#include <map>
#include <optional>
#include <vector>

#include <breakwater/record/csv.h>
#include <breakwater/scenario/table.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {
namespace {

constexpr const char* kFailure = "failure";

std::string digits(double value) {
  return fmt::format("{:.17g}", value);
}

// Its cells by the names of their columns.
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

// A pair's row so far.
template <typename Comparison>
Row begun_row(const CandidateComparison& comparison, const Comparison& one,
              const std::string& metric) {
  Row row;
  row.put("metric", metric);
  row.put("candidate", comparison.candidates[one.candidate]);
  row.put("reference", comparison.candidates[one.reference]);
  row.put("pairs", std::to_string(one.pairs));
  row.put("p", one.p);
  row.put("p_holm", one.p_holm);
  row.put("verdict", name_of(one.verdict));
  return row;
}

std::string brief(double value) {
  return fmt::format("{:.4g}", value);
}

std::string brief(const EstimatedMedian& median) {
  if (!median.interval) return brief(median.value);
  return fmt::format("{} [{}, {}]", brief(median.value), brief(median.interval->lower),
                     brief(median.interval->upper));
}

}  // namespace

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
                                            "average_rank",
                                            "critical_difference"};
  std::string text = csv_line(columns);
  for (const MetricComparison& one : comparison.metrics) {
    Row row = begun_row(comparison, one, one.metric);
    if (one.goal != Goal::none) row.put("goal", name_of(goal_names(), one.goal));
    row.put("median", one.median);
    row.put("reference_median", one.reference_median);
    row.put("difference", one.difference);
    row.put("probability_smaller", one.probability_smaller);
    if (one.probability_better) row.put("probability_better", *one.probability_better);
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
  for (const RankComparison& one : comparison.ranks) {
    for (std::size_t c = 0; c < comparison.candidates.size(); ++c) {
      Row row;
      row.put("metric", one.metric);
      if (one.goal != Goal::none) row.put("goal", name_of(goal_names(), one.goal));
      row.put("candidate", comparison.candidates[c]);
      row.put("pairs", std::to_string(one.worlds));
      row.put("average_rank", one.average_ranks[c]);
      row.put("critical_difference", one.critical_difference);
      text += row.print(columns);
    }
  }
  return text;
}

std::string repeated_text(const CandidateComparison& comparison) {
  std::vector<std::string> repeated;
  for (std::size_t c = 0; c < comparison.candidates.size(); ++c) {
    if (comparison.runs[c] == comparison.worlds) continue;
    repeated.push_back(fmt::format("{} of {}", comparison.runs[c], comparison.candidates[c]));
  }
  if (repeated.empty()) return "";
  return fmt::format(
      "In {} worlds there are but {} different runs: not all that is varied reaches {}; the same "
      "pair counts once",
      comparison.worlds, fmt::join(repeated, ", "), repeated.size() == 1 ? "that one" : "those");
}

std::string never_text(const CandidateComparison& comparison) {
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < comparison.candidates.size(); ++c) {
    if (comparison.never[c].empty()) continue;
    parts.push_back(fmt::format("Not one run of {} has {}", comparison.candidates[c],
                                fmt::join(comparison.never[c], ", ")));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

std::string comparison_text(const CandidateComparison& comparison, std::size_t width) {
  Table table({"metric", "candidate", "reference", "pairs", "median", "difference (95 %)", "p",
               "better in", "verdict"});
  bool has_mark = false;
  const auto counted = [&](std::size_t pairs) {
    const bool is_marked = pairs < comparison.worlds;
    has_mark = has_mark || is_marked;
    return std::to_string(pairs) + (is_marked ? " *" : "");
  };
  for (const MetricComparison& one : comparison.metrics) {
    const bool has_goal = one.probability_better.has_value();
    table.add({one.metric, comparison.candidates[one.candidate],
               comparison.candidates[one.reference], counted(one.pairs), brief(one.median.value),
               brief(one.difference), fmt::format("{:.2g}", one.p_holm),
               has_goal ? fmt::format("{:.0f} %", 100.0 * *one.probability_better) : "-",
               name_of(one.verdict)});
  }
  for (const FailureComparison& one : comparison.failures) {
    table.add({kFailure, comparison.candidates[one.candidate], comparison.candidates[one.reference],
               counted(one.pairs), std::to_string(one.failures),
               fmt::format("{:+d}", static_cast<long>(one.failures) -
                                        static_cast<long>(one.reference_failures)),
               fmt::format("{:.2g}", one.p_holm), "-", name_of(one.verdict)});
  }
  std::string text = table.print(width);
  if (has_mark) {
    text += fmt::format(
        "* of fewer worlds than {}: in the others a run failed or lacks the metric, or "
        "both runs are those of another world\n",
        comparison.worlds);
  }
  const std::string repeated = repeated_text(comparison);
  if (!repeated.empty()) text += repeated + '\n';
  const std::string never = never_text(comparison);
  if (!never.empty()) text += never + '\n';
  return text;
}

}  // namespace breakwater
