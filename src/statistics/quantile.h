// Quantiles, the median and the mean of a sample.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace breakwater {

/// The p-quantile of n ≥ 1 values x₀ ≤ x₁ ≤ …, linearly interpolated, for 0 ≤ p ≤ 1:
///     Q(p) = x_⌊h⌋ + (h − ⌊h⌋)(x_⌊h⌋₊₁ − x_⌊h⌋),  h = (n − 1) p
///
/// Source: R. J. Hyndman, Y. Fan, Amer. Statist. 50 (1996) 361–365, definition 7.
inline double quantile(const std::vector<double>& sorted, double p) {
  const double at = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

/// The middle value, or the mean of the two middle ones; NaN for no values. Reorders its argument.
inline double sample_median(std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return std::midpoint(*std::max_element(values.begin(), middle), *middle);
}

/// The mean. Its bits do not depend on the order of the values, which it sorts.
inline double sample_mean(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace breakwater
