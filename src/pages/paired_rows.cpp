#include <breakwater/pages/paired_rows.h>

#include <fmt/format.h>

#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/study_charts.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
namespace {

void set(mustache::data& row, const std::string& name, const EstimatedMedian& median) {
  row.set(name, format_number(median.value));
  if (!median.interval) return;
  row.set(name + "_interval", fmt::format("{} to {}", format_number(median.interval->lower),
                                          format_number(median.interval->upper)));
}

// A verdict in the page's colours.
void set(mustache::data& row, ComparisonVerdict verdict) {
  row.set("verdict", name_of(verdict));
  row.set("kind", verdict == ComparisonVerdict::better  ? "good"
                  : verdict == ComparisonVerdict::worse ? "off"
                  : verdict == ComparisonVerdict::no_difference_shown ||
                          verdict == ComparisonVerdict::too_few_blocks
                      ? "unknown"
                      : "");
}

template <typename Comparison>
mustache::data begun_row(const CandidateComparison& comparison, const Comparison& one) {
  mustache::data row;
  row.set("candidate", comparison.candidates[one.candidate]);
  row.set("reference", comparison.candidates[one.reference]);
  row.set("blocks", std::to_string(one.blocks));
  row.set("is_fewer", one.blocks < comparison.blocks);
  row.set("count", std::to_string(one.pairs));
  row.set("p", p_text(one.p_holm));
  set(row, one.verdict);
  return row;
}

void set_pairs(mustache::data& section, const CandidateComparison& comparison,
               const mustache::data& pairs) {
  section.set("has_pairs", !pairs.is_empty_list());
  section.set("pairs", pairs);
  section.set("all_blocks", std::to_string(comparison.blocks));
  section.set("has_repeats", comparison.has_repeats());
  section.set("repeated", repeated_text(comparison));
  const std::string few = few_text(comparison);
  if (!few.empty()) section.set("few", few);  // an empty text counts as there
  section.set("never", never_text(comparison));
}

}  // namespace

void add_paired_metric(const CandidateComparison& comparison, const std::string& metric,
                       mustache::data& section) {
  mustache::data pairs(mustache::data::type::list);
  for (const MetricComparison& one : comparison.metrics) {
    if (one.metric != metric) continue;
    mustache::data row = begun_row(comparison, one);
    set(row, "median", one.median);
    set(row, "reference_median", one.reference_median);
    set(row, "difference", one.difference);
    const double share = one.probability_better.value_or(one.probability_smaller);
    row.set("share", fmt::format("{:.0f} %", 100.0 * share));
    row.set("between", one.between ? fmt::format("{:.3g} %", 100.0 * *one.between) : "–");
    row.set("turns_with", fmt::format("{}", fmt::join(one.turns_with, ", ")));
    row.set("turns", !one.turns_with.empty());
    section.set("share_is", one.probability_better ? "better in" : "smaller in");
    pairs << row;
  }
  set_pairs(section, comparison, pairs);
}

mustache::data turn_of(const CandidateComparison& comparison, const KeyInteraction& one,
                       Identity look) {
  mustache::data turn;
  turn.set("key", one.key);
  turn.set("candidate", comparison.candidates[one.candidate]);
  turn.set("reference", comparison.candidates[one.reference]);
  turn.set("p", p_text(one.p_holm));
  turn.set("repeats_are", one.is_of_worlds ? "seeds of the value’s one block" : "blocks");
  LineChart chart;
  chart.x_title = key_label_with_unit(one.key, unit_of(one.key));
  chart.y_title =
      fmt::format("{}, {} less {}", metric_label_with_unit(one.metric, unit_of(one.metric)),
                  comparison.candidates[one.candidate], comparison.candidates[one.reference]);
  chart.is_log_x = one.is_log;
  chart.lines.resize(1);
  chart.looks = {look};
  mustache::data rows(mustache::data::type::list);
  for (const KeyInteraction::Value& value : one.values) {
    mustache::data row;
    row.set("value", value.label);
    row.set("repeats", std::to_string(value.repeats));
    row.set("difference", format_number(value.median));
    row.set("tenths", format_number(value.q10) + " to " + format_number(value.q90));
    row.set("sign", value.median < 0.0 ? "smaller" : value.median > 0.0 ? "larger" : "the same");
    rows << row;
    LineMark mark;
    mark.x = value.x;
    mark.y = value.median;
    mark.lower = value.q10;
    mark.upper = value.q90;
    mark.text = fmt::format("{} = {}: {} ({} to {}), {} repeats", one.key, value.label,
                            format_number(value.median), format_number(value.q10),
                            format_number(value.q90), value.repeats);
    chart.x.push_back(value.x);
    chart.x_labels.push_back(value.label);
    chart.lines.back().push_back(std::move(mark));
  }
  turn.set("values", rows);
  turn.set("svg", draw(chart));
  return turn;
}

void add_paired_failures(const CandidateComparison& comparison, mustache::data& section) {
  mustache::data pairs(mustache::data::type::list);
  for (const FailureComparison& one : comparison.failures) {
    mustache::data row = begun_row(comparison, one);
    row.set("failed", std::to_string(one.failures));
    row.set("reference_failed", std::to_string(one.reference_failures));
    row.set("alone", std::to_string(one.alone));
    row.set("reference_alone", std::to_string(one.reference_alone));
    pairs << row;
  }
  set_pairs(section, comparison, pairs);
}

}  // namespace breakwater
