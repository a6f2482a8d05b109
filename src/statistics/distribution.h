// The distribution of one varied key.
#pragma once

namespace breakwater {

enum class DistributionKind { uniform, log_uniform, normal };

/// The distribution of one quantity:
///     uniform [a, b]        Q(u) = a + (b − a) u
///     log_uniform [a, b]    Q(u) = a (b/a)ᵘ                the logarithm is uniform
///     normal [m, s]         Q(u) = m + s Φ⁻¹(u)            mean m, standard deviation s
/// Q is the quantile function: of a u that is uniform in (0, 1) it makes a value so distributed,
/// and u that fill the interval evenly fill the distribution evenly.
class Distribution {
 public:
  /// Throws std::invalid_argument if a number is not finite, a ≥ b, a ≤ 0 in a log_uniform, b − a
  /// or b/a is too large for a double, or s ≤ 0.
  Distribution(DistributionKind kind, double first, double second);

  /// Q(u), the same bits on every processor. A value of a range lies in it, ends included. Throws
  /// std::invalid_argument unless 0 < u < 1.
  double quantile(double u) const;
  /// Whether it has ends.
  bool is_bounded() const { return kind_ != DistributionKind::normal; }

 private:
  DistributionKind kind_;
  double first_;
  double second_;
};

/// Φ⁻¹(u), the standard normal quantile, for 0 < u < 1; to 1e-15 relative, and the same bits on
/// every processor.
///
/// Source: M. J. Wichura, Algorithm AS 241, Appl. Statist. 37 (1988) 477–484, routine PPND16.
double normal_quantile(double u);

}  // namespace breakwater
