// What an encoder's code tells of a normally distributed position.
#pragma once

namespace breakwater {

/// A standard normal z that is known to lie between α and β. Nothing underflows that matters: |α|
/// and |β| may be large, and both on one side.
class CodeInterval {
 public:
  struct Moments {
    double mean;
    double variance;
  };

  /// α < β.
  CodeInterval(double alpha, double beta);

  /// ln P(α < z < β).
  double log_mass() const;
  /// P(z < α) + P(z > β).
  double outside() const;
  /// Of z, given that it lies there: the exact ones of the truncated normal distribution,
  ///     E = (φ(α) − φ(β))/P,   Var = 1 + (α φ(α) − β φ(β))/P − E²,
  /// to some 1e-16·(1 + α²)/(β − α)².
  Moments moments() const;

 private:
  double sign_;   // mirrored, so that the interval, or most of it, lies right of 0
  double lower_;  // its bounds, mirrored: |lower| ≤ upper
  double upper_;
  double outside_;       // of an interval with 0 within
  double lower_weight_;  // φ(lower), φ(upper) and the mass, as they are or, right of 0, over
  double upper_weight_;  // φ(lower)
  double mass_;
};

}  // namespace breakwater
