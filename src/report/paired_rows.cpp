#include <breakwater/report/paired_rows.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include <breakwater/report/thesis_report.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
namespace {

std::string p_value(double p) {
  return p < 1e-4 ? fmt::format("{:.0e}", p) : fmt::format("{:.2g}", p);
}

void set(mustache::data& row, const std::string& name, const EstimatedMedian& median) {
  row.set(name, format_number(median.value));
  if (!median.interval) return;
  row.set(name + "_interval", fmt::format("{} to {}", format_number(median.interval->lower),
                                          format_number(median.interval->upper)));
}

// A verdict in the page's colours.
void set(mustache::data& row, ComparisonVerdict verdict) {
  row.set("verdict", name_of(verdict));
  row.set("kind", verdict == ComparisonVerdict::better                ? "good"
                  : verdict == ComparisonVerdict::worse               ? "off"
                  : verdict == ComparisonVerdict::no_difference_shown ? "unknown"
                                                                      : "");
}

template <typename Comparison>
mustache::data begun_row(const CandidateComparison& comparison, const Comparison& one) {
  mustache::data row;
  row.set("candidate", comparison.candidates[one.candidate]);
  row.set("reference", comparison.candidates[one.reference]);
  row.set("count", std::to_string(one.pairs));
  row.set("is_fewer", one.pairs < comparison.worlds);
  row.set("p", p_value(one.p_holm));
  set(row, one.verdict);
  return row;
}

void set_pairs(mustache::data& section, const CandidateComparison& comparison,
               const mustache::data& pairs) {
  section.set("has_pairs", !pairs.is_empty_list());
  section.set("pairs", pairs);
  section.set("worlds", std::to_string(comparison.worlds));
  section.set("repeated", repeated_text(comparison));
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
    section.set("share_is", one.probability_better ? "better in" : "smaller in");
    pairs << row;
  }
  set_pairs(section, comparison, pairs);

  mustache::data ranks(mustache::data::type::list);
  for (const RankComparison& one : comparison.ranks) {
    if (one.metric != metric) continue;
    std::vector<std::size_t> order(one.average_ranks.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return one.average_ranks[a] < one.average_ranks[b];
    });
    for (const std::size_t c : order) {
      mustache::data rank;
      rank.set("label", comparison.candidates[c]);
      rank.set("rank", fmt::format("{:.2f}", one.average_ranks[c]));
      ranks << rank;
    }
    section.set("critical_difference", fmt::format("{:.2f}", one.critical_difference));
    section.set("ranked_worlds", std::to_string(one.worlds));
  }
  section.set("has_ranks", !ranks.is_empty_list());
  section.set("ranks", ranks);
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
