// Wilcoxon's signed-rank test, with the estimate and the interval that belong to it.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <breakwater/statistics/distribution.h>

namespace breakwater {

/// The test of n ≥ 1 differences d of pairs, by their M = n (n + 1)/2 Walsh averages
/// a_ij = (d_i + d_j)/2, i ≤ j. The tested hypothesis is that the differences are symmetric about
/// zero:
///     W = min(#{a ≤ 0}, #{a ≥ 0})
///     p = min(1, 2 P(W₊ ≤ W))      W₊: the sum of those of the ranks 1 … n whose fair coin is
///     heads
/// Without zeros and equal magnitudes this is Wilcoxon's two-sided test. An average of zero counts
/// for both sides, so that ties never make p too small. P is exact for n ≤ 200, else from the
/// normal distribution with a continuity correction of 1/2.
///
/// Sources: F. Wilcoxon, Biometrics Bull. 1 (1945) 80–83; J. W. Tukey, Princeton Statistical
/// Research Group, Memorandum 17, 1949; J. L. Hodges, E. L. Lehmann, Ann. Math. Statist. 34 (1963)
/// 598–611.
class SignedRank {
 public:
  /// The differences must be finite. Averages up to `zero` in magnitude are zero: so large may be
  /// the rounding error of a difference.
  explicit SignedRank(std::vector<double> differences, double zero = 0.0);

  double p() const;
  /// The median of the Walsh averages, which estimates the pseudo-median: the median of (D + D')/2
  /// for two independent differences. For a symmetric distribution it is the median.
  double pseudo_median() const;
  /// [k-th smallest, k-th largest Walsh average], k − 1 the largest w with 2 P(W₊ ≤ w) ≤ alpha. It
  /// excludes zero exactly where p ≤ alpha. For symmetric differences it covers the pseudo-median
  /// with probability 1 − alpha or more, for others about so. Nothing if 2·2⁻ⁿ > alpha: with five
  /// differences or fewer at 5 %.
  std::optional<ConfidenceInterval> interval(double alpha) const;
  /// The share of a_ij, i < j, above zero; those of zero count half. 1/2 for n = 1.
  double share_above() const;

 private:
  std::size_t size() const { return sorted_.size(); }
  std::size_t averages() const { return size() * (size() + 1) / 2; }
  std::size_t at_most(double value) const;  // number of Walsh averages
  double last_below_zero() const;           // the largest number below zero
  double average(std::size_t k) const;      // the k-th smallest, from 1
  double cdf(std::size_t w) const;          // P(W₊ ≤ w)

  std::vector<double> sorted_;
  double zero_;
  std::vector<double> cdf_;  // empty for large n
};

/// The number n of differences with which the test at level alpha rejects with a probability of
/// 80 %. Two differences D, D' have P(D + D' > 0) = share_above:
///     n = (Φ⁻¹(1 − α/2) + Φ⁻¹(0.8))² / (3 (share_above − 1/2)²),  but 2·2⁻ⁿ ≤ α
/// Nothing above a million.
///
/// Source: G. E. Noether, J. Amer. Statist. Assoc. 82 (1987) 645–647.
std::optional<std::size_t> differences_needed(double share_above, double alpha);

}  // namespace breakwater
