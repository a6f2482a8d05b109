#include <breakwater/pages/paired_rows.h>

#include <fmt/format.h>

#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace {

void set(PageData& row, const std::string& name, const EstimatedMedian& median) {
  row[name] = format_number(median.value);
  if (!median.interval) return;
  row[name + "_interval"] = fmt::format("{} to {}", format_number(median.interval->lower),
                                        format_number(median.interval->upper));
}

// A verdict in the page's colours.
void set(PageData& row, ComparisonVerdict verdict) {
  row["verdict"] = name_of(verdict);
  row["kind"] = verdict == ComparisonVerdict::better  ? "good"
                : verdict == ComparisonVerdict::worse ? "off"
                : verdict == ComparisonVerdict::no_difference_shown ||
                        verdict == ComparisonVerdict::too_few_blocks
                    ? "unknown"
                    : "";
}

template <typename Comparison>
PageData begun_row(const CandidateComparison& comparison, const Comparison& one) {
  PageData row;
  row["candidate"] = comparison.candidates[one.candidate];
  row["reference"] = comparison.candidates[one.reference];
  row["blocks"] = one.blocks;
  row["is_fewer"] = one.blocks < comparison.blocks;
  row["count"] = one.pairs;
  row["p"] = p_text(one.p_holm);
  set(row, one.verdict);
  return row;
}

void set_pairs(PageData& section, const CandidateComparison& comparison, const PageData& pairs) {
  section["pairs"] = pairs;
  section["all_blocks"] = comparison.blocks;
  section["has_repeats"] = comparison.has_repeats();
  section["repeated"] = repeated_text(comparison);
  section["few"] = few_text(comparison);
  section["never"] = never_text(comparison);
}

}  // namespace

void add_paired_metric(const CandidateComparison& comparison, const std::string& metric,
                       PageData& section) {
  auto pairs = PageData::array();
  for (const MetricComparison& one : comparison.metrics) {
    if (one.metric != metric) continue;
    PageData row = begun_row(comparison, one);
    set(row, "median", one.median);
    set(row, "reference_median", one.reference_median);
    set(row, "difference", one.difference);
    const double share = one.probability_better.value_or(one.probability_smaller);
    row["share"] = fmt::format("{:.0f} %", 100.0 * share);
    row["between"] = one.between ? fmt::format("{:.3g} %", 100.0 * *one.between) : "–";
    row["turns_with"] = fmt::format("{}", fmt::join(one.turns_with, ", "));
    row["turns"] = !one.turns_with.empty();
    section["share_is"] = one.probability_better ? "better in" : "smaller in";
    pairs.push_back(row);
  }
  set_pairs(section, comparison, pairs);
}

PageData turn_of(const CandidateComparison& comparison, const KeyInteraction& one, Identity look,
                 RunList& runs) {
  const std::string& candidate = comparison.candidates[one.candidate];
  const std::string& reference = comparison.candidates[one.reference];
  auto rows = PageData::array();
  auto marks = PageData::array();
  auto at = PageData::array();
  auto labels = PageData::array();
  for (const KeyInteraction::Value& value : one.values) {
    rows.push_back({{"value", value.label},
                    {"repeats", value.repeats},
                    {"difference", format_number(value.median)},
                    {"tenths", format_number(value.q10) + " to " + format_number(value.q90)},
                    {"sign", value.median < 0.0   ? "smaller"
                             : value.median > 0.0 ? "larger"
                                                  : "the same"}});
    marks.push_back(
        {{"y", value.median},
         {"low", value.q10},
         {"high", value.q90},
         {"runs", PageData::array()},
         {"text", fmt::format("{} = {}: {} ({} to {}), {} repeats", one.key, value.label,
                              format_number(value.median), format_number(value.q10),
                              format_number(value.q90), value.repeats)}});
    at.push_back(value.x);
    labels.push_back(value.label);
  }
  return {{"key", one.key},
          {"candidate", candidate},
          {"reference", reference},
          {"p", p_text(one.p_holm)},
          {"repeats_are", one.is_of_worlds ? "seeds of the value’s one block" : "blocks"},
          {"values", rows},
          {"lines", runs.drawing({{"kind", "lines"},
                                  {"x_title", key_label_with_unit(one.key, unit_of(one.key))},
                                  {"y_title", fmt::format("{}, {} less {}",
                                                          metric_label_with_unit(
                                                              one.metric, unit_of(one.metric)),
                                                          candidate, reference)},
                                  {"log", one.is_log},
                                  {"share", false},
                                  {"at", at},
                                  {"labels", labels},
                                  {"looks", PageData::array({series_class(look)})},
                                  {"lines", PageData::array({marks})}})}};
}

void add_paired_failures(const CandidateComparison& comparison, PageData& section) {
  auto pairs = PageData::array();
  for (const FailureComparison& one : comparison.failures) {
    PageData row = begun_row(comparison, one);
    row["failed"] = one.failures;
    row["reference_failed"] = one.reference_failures;
    row["alone"] = one.alone;
    row["reference_alone"] = one.reference_alone;
    pairs.push_back(row);
  }
  set_pairs(section, comparison, pairs);
}

}  // namespace breakwater
