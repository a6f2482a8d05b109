#include <breakwater/pages/study_finding.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace {

bool is_shown(const MetricComparison& one) {
  return one.verdict != ComparisonVerdict::no_difference_shown &&
         one.verdict != ComparisonVerdict::too_few_blocks;
}

// "−1.5": a minus sign, not a hyphen.
std::string number_text(double value) {
  return (value < 0.0 ? "−" : "") + format_number(std::abs(value));
}

// "(median 8 N)".
std::string median_text(double value, const std::string& unit) {
  return fmt::format("(median {}{})", number_text(value), unit_after(unit));
}

// "by −1.5 N (median over 12 blocks; 95 % confidence interval −2 to −1 N)". Only the first of a
// sentence says what its numbers are.
std::string difference(const MetricComparison& one, const std::string& unit, bool is_first) {
  const double by = one.difference.value;
  std::string text =
      fmt::format("by {}{}{}", by > 0.0 ? "+" : "", number_text(by), unit_after(unit));
  if (one.difference.interval) {
    const std::string low = number_text(one.difference.interval->lower);
    const std::string high = number_text(one.difference.interval->upper);
    // All blocks in the interval have the same difference: an interval says no more.
    text +=
        low == high
            ? " in most blocks"
            : fmt::format(
                  " ({}{} {} to {}{})",
                  is_first ? fmt::format("median over {}; ", number_of(one.blocks, "block")) : "",
                  is_first ? "95 % confidence interval" : "95 %:", low, high, unit_after(unit));
  }
  if (one.verdict == ComparisonVerdict::better || one.verdict == ComparisonVerdict::worse) {
    text += ", which is " + name_of(one.verdict);
  }
  return text;
}

std::string listed(const std::vector<std::string>& names) {
  if (names.size() < 2) return names.empty() ? "" : names.front();
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

// The last value of the key with the first sign, and the first with the other.
std::string turn(const CandidateComparison& comparison, const KeyInteraction& one) {
  const auto sign = [](const KeyInteraction::Value& value) { return value.median < 0.0; };
  const auto after = std::find_if(one.values.begin(), one.values.end(), [&](const auto& value) {
    return sign(value) != sign(one.values.front());
  });
  if (after == one.values.end()) return "";
  const auto word = [&](const auto& value) { return sign(value) ? "smaller" : "larger"; };
  return fmt::format(" The sign of the difference turns with {}: {} is {} at {} and {} at {}.",
                     one.key, comparison.candidates[one.candidate], word(*(after - 1)),
                     (after - 1)->label, word(*after), after->label);
}

}  // namespace

std::string finding(const CandidateComparison& comparison, const std::string& metric) {
  std::vector<const MetricComparison*> all;
  for (const MetricComparison& one : comparison.metrics) {
    const bool is_of_first = all.empty() || one.reference == all.front()->reference;
    if (one.metric == metric && is_of_first) all.push_back(&one);
  }
  if (all.empty()) return "";
  const std::string unit = unit_of(metric);
  const std::string reference = fmt::format("{} {}", comparison.candidates[all.front()->reference],
                                            median_text(all.front()->reference_median.value, unit));
  std::vector<std::string> parts, unshown;
  std::string turns;
  double least_p = 1.0;
  bool are_few = false;
  for (const MetricComparison* one : all) {
    const std::string& name = comparison.candidates[one->candidate];
    if (is_shown(*one)) {
      const bool is_first = parts.empty();
      parts.push_back(fmt::format("{} {}{}", name,
                                  is_first ? fmt::format("differs from {} ", reference) : "",
                                  difference(*one, unit, is_first)));
    } else {
      unshown.push_back(fmt::format("{} {}", name, median_text(one->median.value, unit)));
      least_p = std::min(least_p, one->p_holm);
      are_few |= one->verdict == ComparisonVerdict::too_few_blocks;
    }
    for (const KeyInteraction& key : comparison.interactions) {
      if (key.turns && key.metric == metric && key.candidate == one->candidate &&
          key.reference == one->reference)
        turns += turn(comparison, key);
    }
  }
  if (!unshown.empty()) {
    const std::string blocks = number_of(all.front()->blocks, "block");
    parts.push_back(fmt::format(
        "no difference{} is shown for {}, {}",
        parts.empty() ? fmt::format(" from {}", reference) : "", listed(unshown),
        are_few ? fmt::format("because {} are too few", blocks)
                : fmt::format("p ≥ {} for {} with Holm’s correction", p_text(least_p), blocks)));
  }
  return fmt::format("{}: {}.{}", metric_label(metric, unit), fmt::join(parts, "; "), turns);
}

}  // namespace breakwater
