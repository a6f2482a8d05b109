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

std::string size_of(double value, const std::string& unit) {
  return format_number(std::abs(value)) + (unit == "1" || unit.empty() ? "" : " " + unit);
}

// "larger by 1.07 N (95 %: 0.93 to 1.2)".
std::string difference(const MetricComparison& one, const std::string& unit) {
  const double by = one.difference.value;
  std::string text = fmt::format("{} by {}", by < 0.0 ? "smaller" : "larger", size_of(by, unit));
  if (one.difference.interval) {
    double low = std::abs(one.difference.interval->lower);
    double high = std::abs(one.difference.interval->upper);
    if (low > high) std::swap(low, high);
    text += fmt::format(" (95 %: {} to {})", format_number(low), format_number(high));
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
  return fmt::format(" Its sign turns with {}: {} is {} at {} and {} at {}.", one.key,
                     comparison.candidates[one.candidate], word(*(after - 1)), (after - 1)->label,
                     word(*after), after->label);
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
  const std::string& reference = comparison.candidates[all.front()->reference];
  std::vector<std::string> parts, unshown;
  std::string turns;
  double least_p = 1.0;
  bool are_few = false;
  for (const MetricComparison* one : all) {
    const std::string& name = comparison.candidates[one->candidate];
    if (is_shown(*one)) {
      parts.push_back(fmt::format("{} is {}", name, difference(*one, unit)));
    } else {
      unshown.push_back(fmt::format("{} (median {})", name, size_of(one->median.value, unit)));
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
        "no difference is shown for {}, {}", listed(unshown),
        are_few ? fmt::format("because {} are too few", blocks)
                : fmt::format("p ≥ {} for {} with Holm’s correction", p_text(least_p), blocks)));
  }
  return fmt::format("{} compared with {} (median {}): {}.{}", metric_label(metric, unit),
                     reference, size_of(all.front()->reference_median.value, unit),
                     fmt::join(parts, "; "), turns);
}

}  // namespace breakwater
