// Likelihood of an encoder code for a normally distributed position.
#pragma once

namespace breakwater {

/// A standard normal z between α and β. Large |α| and |β|, also of equal sign, do not underflow.
class CodeInterval {
 public:
  struct Moments {
    double mean;
    double variance;
  };

  /// Requires α < β.
  CodeInterval(double alpha, double beta);

  /// ln P(α < z < β).
  double log_mass() const;
  /// P(z < α) + P(z > β).
  double outside() const;
  /// Mean and variance of z in the interval: the moments of the truncated normal distribution,
  ///     E = (φ(α) − φ(β))/P,   Var = 1 + (α φ(α) − β φ(β))/P − E²,
  /// with an error of about 1e-16·(1 + α²)/(β − α)².
  Moments moments() const;

 private:
  double sign_;   // mirrors z so that most of the interval lies right of 0
  double lower_;  // the mirrored bounds: |lower| ≤ upper
  double upper_;
  double outside_;       // for an interval that contains 0
  double lower_weight_;  // φ(lower), φ(upper) and the mass,
  double upper_weight_;  // divided by φ(lower) if the interval lies right of 0
  double mass_;
};

}  // namespace breakwater
