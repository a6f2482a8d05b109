// The distribution of a varied key, quantiles and means of a sample, and confidence intervals.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace breakwater {

struct ConfidenceInterval {
  double lower = std::numeric_limits<double>::quiet_NaN();
  double upper = std::numeric_limits<double>::quiet_NaN();
};

/// One number from many runs, with a confidence interval if there is one.
struct EstimatedValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::optional<ConfidenceInterval> interval = {};
};

/// P(X ≤ 0) … P(X ≤ n) of a binomial X: n ≥ 1 trials with success probability p, 0 < p < 1. The
/// error is below 1e-11. The bits are the same on every processor.
std::vector<double> binomial_cdf(std::size_t n, double p);

/// A confidence interval of the p-quantile of a continuous distribution, from a sorted sample:
///     [x_l, x_u],  l the largest, u the smallest with P(X < l) ≤ (1 − level)/2,
///                                                     P(X ≥ u) ≤ (1 − level)/2,  X ~ Bin(n, p)
/// It covers the quantile with probability `level` or more, for any distribution. Empty if the
/// sample is too small for either end: for a median at 95 % with five values or fewer.
///
/// Source: H. A. David, H. N. Nagaraja, Order Statistics, 3rd ed., 2003, section 7.1.
std::optional<ConfidenceInterval> quantile_interval(const std::vector<double>& sorted, double p,
                                                    double level);

/// The interval of the success probability of n ≥ 1 trials with so many successes:
///     [p_l, p_u],  P(X ≥ successes) = (1 − level)/2 for p_l,  P(X ≤ successes) likewise for p_u
/// p_l is 0 without a success, p_u is 1 without a failure. It covers with probability `level` or
/// more. The error is below 1e-9.
///
/// Source: C. J. Clopper, E. S. Pearson, Biometrika 26 (1934) 404–413.
ConfidenceInterval share_interval(std::size_t successes, std::size_t n, double level);

/// McNemar's exact test of paired failures. In `first` pairs only the first run failed, in `second`
/// only the second. Returns the two-sided p of first ~ Bin(first + second, 1/2); 1 if both are 0.
///
/// Source: Q. McNemar, Psychometrika 12 (1947) 153–157, with the exact distribution.
double mcnemar_exact(std::size_t first, std::size_t second);

enum class DistributionKind { uniform, log_uniform, normal };

/// The distribution of one quantity by its quantile function Q:
///     uniform [a, b]        Q(u) = a + (b − a) u
///     log_uniform [a, b]    Q(u) = a (b/a)ᵘ                the logarithm is uniform
///     normal [m, s]         Q(u) = m + s Φ⁻¹(u)            mean m, standard deviation s
/// A uniform u in (0, 1) gives a value Q(u) with this distribution. Evenly spread u give evenly
/// spread values.
class Distribution {
 public:
  /// Throws std::invalid_argument if a number, b − a or b/a is not finite, a ≥ b, s ≤ 0, or a ≤ 0
  /// for log_uniform.
  Distribution(DistributionKind kind, double first, double second);

  /// Q(u), with the same bits on every processor. The value lies in the range, ends included.
  /// Throws std::invalid_argument unless 0 < u < 1.
  double quantile(double u) const;
  /// Whether the range is finite.
  bool is_bounded() const { return kind_ != DistributionKind::normal; }

 private:
  DistributionKind kind_;
  double first_;
  double second_;
};

/// Φ⁻¹(u), the standard normal quantile, for 0 < u < 1. The relative error is below 1e-15. The bits
/// are the same on every processor.
///
/// Source: M. J. Wichura, Algorithm AS 241, Appl. Statist. 37 (1988) 477–484, routine PPND16.
double normal_quantile(double u);

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
