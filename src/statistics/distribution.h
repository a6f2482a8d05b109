// The distribution of a varied key.
#pragma once

namespace breakwater {

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

}  // namespace breakwater
