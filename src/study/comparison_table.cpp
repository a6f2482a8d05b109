#include <breakwater/study/comparison_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <breakwater/config/names.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

constexpr const char* kOfTheOther = "of the other";  // a column that a terminal has no room for

std::string percent(double share) {
  return fmt::format("{:.0f} %", 100.0 * share);
}

}  // namespace

std::string p_text(double p, const std::string& equals) {
  return p < 1e-15 ? "< 1e-15" : fmt::format("{}{:.2g}", equals, p);
}

std::string comparison_csv(const CandidateComparison& comparison) {
  std::vector<ResultRow> rows;
  // The cells of a pair, with those of its metric or of its failures.
  const auto add = [&](const auto& one, const MetricComparison* metric,
                       const FailureComparison* failure) {
    ResultRow& row = rows.emplace_back();
    const Goal goal = metric != nullptr ? metric->goal : Goal::min;
    row.put("metric", metric != nullptr ? metric->metric : kFailure);
    row.put("goal", goal == Goal::none ? "" : name_of(goal_names(), goal));
    row.put("candidate", comparison.candidates[one.candidate]);
    row.put("reference", comparison.candidates[one.reference]);
    row.put("pairs", std::to_string(one.pairs));
    const EstimatedValue none{std::nan("")};
    row.put("median", metric != nullptr ? metric->median : none);
    row.put("reference_median", metric != nullptr ? metric->reference_median : none);
    row.put("difference", metric != nullptr ? metric->difference : none);
    row.put("p", one.p);
    row.put("p_holm", one.p_holm);
    row.put("probability_smaller", metric != nullptr ? metric->probability_smaller : none.value);
    row.put("probability_better",
            metric != nullptr ? metric->probability_better.value_or(none.value) : none.value);
    row.put("verdict", name_of(one.verdict));
    const auto count = [&](const char* column, std::size_t FailureComparison::*number) {
      row.put(column, failure != nullptr ? std::to_string(failure->*number) : "");
    };
    count("failures", &FailureComparison::failures);
    count("reference_failures", &FailureComparison::reference_failures);
    count("failures_alone", &FailureComparison::alone);
    count("reference_failures_alone", &FailureComparison::reference_alone);
    row.put("blocks", std::to_string(one.blocks));
  };
  for (const MetricComparison& one : comparison.metrics) add(one, &one, nullptr);
  for (const FailureComparison& one : comparison.failures) add(one, nullptr, &one);
  return csv_table(rows);
}

std::size_t blocks_for_verdict(std::size_t blocks, std::size_t tests) {
  const double alpha = ComparisonSettings{}.alpha;
  while (least_p(blocks, std::max<std::size_t>(1, tests)) > alpha) ++blocks;
  return blocks;
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

namespace {

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

std::string few_text(const CandidateComparison& comparison) {
  const auto is_few = [](const auto& one) {
    return one.verdict == ComparisonVerdict::too_few_blocks;
  };
  const auto metric = std::find_if(comparison.metrics.begin(), comparison.metrics.end(), is_few);
  if (metric == comparison.metrics.end()) return "";
  return breakwater::few_text(metric->blocks, metric->pairs, comparison.tests,
                              metric->least_p_holm);
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

}  // namespace

nlohmann::ordered_json comparison_pairs(const CandidateComparison& comparison) {
  using Json = nlohmann::ordered_json;
  const bool has_repeats = comparison.has_repeats();
  Json columns = {"metric", "candidate", "reference", "verdict", "blocks"};
  if (has_repeats) columns.push_back("pairs");
  columns.insert(columns.end(), {"median", kOfTheOther, "difference (95 %)", "p", "better in"});
  auto rows = Json::array();
  const auto with_line = [](const std::string& value, const std::string& line) {
    Json cell = {{"value", value}, {"lines", Json::array()}};
    if (!line.empty()) cell["lines"].push_back({{"text", line}, {"kind", "spread"}});
    return cell;
  };
  const auto median = [&](const EstimatedValue& one) {
    return with_line(in_digits(one.value),
                     one.interval ? fmt::format("{} to {}", in_digits(one.interval->lower),
                                                in_digits(one.interval->upper))
                                  : "");
  };
  const auto add = [&](const std::string& metric, const auto& one, const std::vector<Json>& numbers,
                       const Json& share) {
    const char* const tone = one.verdict == ComparisonVerdict::better  ? "good"
                             : one.verdict == ComparisonVerdict::worse ? "off"
                             : one.verdict == ComparisonVerdict::no_difference_shown ||
                                     one.verdict == ComparisonVerdict::too_few_blocks
                                 ? "unknown"
                                 : "";
    Json row = {metric,
                comparison.candidates[one.candidate],
                comparison.candidates[one.reference],
                {{"value", name_of(one.verdict)}, {"tone", tone}},
                fmt::format("{}{}", one.blocks, one.blocks < comparison.blocks ? " *" : "")};
    if (has_repeats) row.push_back(std::to_string(one.pairs));
    for (const Json& number : numbers) row.push_back(number);
    row.insert(row.end(), {p_text(one.p_holm), share});
    rows.push_back(row);
  };
  for (const MetricComparison& one : comparison.metrics) {
    add(one.metric, one, {median(one.median), median(one.reference_median), brief(one.difference)},
        one.probability_better ? Json(percent(*one.probability_better))
                               : with_line("-", "smaller in " + percent(one.probability_smaller)));
  }
  for (const FailureComparison& one : comparison.failures) {
    const auto difference = static_cast<long>(one.failures - one.reference_failures);
    add(kFailure, one,
        {std::to_string(one.failures), std::to_string(one.reference_failures),
         with_line(fmt::format("{:+d}", difference),
                   fmt::format("{} alone, the other {}", one.alone, one.reference_alone))},
        "-");
  }
  return {{"label", "Paired comparison"}, {"columns", columns}, {"rows", rows}};
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
  for (const std::string& note : {few_text(comparison), repeated_text(comparison),
                                  never_text(comparison), signed_text(comparison)}) {
    if (!note.empty()) notes.push_back(note);
  }
  return notes;
}

std::string comparison_text(const CandidateComparison& comparison, std::size_t width) {
  const nlohmann::ordered_json pairs = comparison_pairs(comparison);
  constexpr std::size_t kLabels = 3;
  const auto place = std::ranges::find(pairs["columns"], kOfTheOther);
  const auto texts = [&](const nlohmann::ordered_json& cells) {
    std::vector<std::string> all;
    for (const auto& cell : cells) all.push_back(cell.is_object() ? cell["value"] : cell);
    all.erase(all.begin() + (place - pairs["columns"].begin()));
    std::rotate(all.begin() + kLabels, all.begin() + kLabels + 1, all.end());  // verdict: last
    return all;
  };
  Table table(texts(pairs["columns"]), kLabels);
  for (const auto& row : pairs["rows"]) table.add(texts(row));
  std::string text = table.print(width);
  for (const std::string& note : comparison_notes(comparison)) {
    text += fmt::format("{}\n", fmt::join(wrapped(note, width), "\n"));
  }
  return text;
}

}  // namespace breakwater
