// The likelihood of an encoder code, and how a code corrects a Kalman filter whose first states
// are position and velocity.
#pragma once

#include <breakwater/math/error_function.h>
#include <breakwater/math/functions.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {

/// The error of the arithmetic, in the output's unit.
inline constexpr double kCodeRounding = 2e-10;
/// A smaller relative fall of a variance counts as none.
inline constexpr double kSmallestFall = 1e-12;

/// Updates the states by new knowledge of z = x̄_i + noise, z ~ N(ẑ, S). The mean of z moves by
/// `shift`, and S falls by the fraction `fall`. This equals a Kalman update with R = S/fall − P_ii,
/// in Joseph's form.
template <typename State, typename Covariance>
void correct_along(State& x, Covariance& P, int i, double S, double shift, double fall) {
  const auto cross = P.col(i).eval();
  x += cross * (shift / S);
  if (!(fall > kSmallestFall)) return;
  const double R = S / fall - cross(i);
  const auto K = (cross * (fall / S)).eval();
  const auto M = (P - K * cross.transpose()).eval();
  const auto corrected = (M + (K * R - M.col(i)) * K.transpose()).eval();
  P = 0.5 * (corrected + corrected.transpose());
}

/// The logarithm of the density of N(0, S) at e.
double log_density(double e, double S);

/// The likelihood of an encoder code, and the correction that it makes:
/// docs/explanation/methods/multiple-model-estimator.md, "How a code corrects a model".
class CodeSensor {
 public:
  /// The content of one sample.
  struct Observation {
    double y;
    CodeRange range;
    double moved;  ///< counts since the last code; NaN: there is none
  };
  /// A filter's prediction of this sample. `outside`: the result of outside() at the last one,
  /// or 1.
  struct Prediction {
    double position, position_variance, velocity, velocity_variance, outside;
  };
  /// For a position outside the gate of a code: the factor of the filter's covariance, and the
  /// log-likelihood before, which bounds the one after. Otherwise 1 and infinity.
  struct Consistency {
    double inflation, charged;
  };
  /// The arguments of correct_along() for the position, and the logarithm of the likelihood.
  struct Update {
    double S, shift, fall, log_likelihood;
    bool is_fine;  ///< the code is so narrow that it counts as a number
  };

  /// Errors of one output. Throws as check(SensorError) does.
  explicit CodeSensor(const SensorError& error);

  /// Forgets the last code.
  void reset() { has_output_ = false; }
  /// Adds noise with this standard deviation to that of the sensor, until the next call.
  void add_noise(double std);
  /// Stores the code y, which must be finite, for the next sample.
  Observation observe(double y);

  /// s²: the variance of the sensor's noise and of the arithmetic.
  double noise_variance() const { return noise_variance_; }
  double last_output() const { return last_output_; }

  /// Log-likelihood of a code for the innovation e of variance S, from its interval's probability.
  double log_likelihood(double e, double S, const CodeRange& range) const;
  /// Consistency first: call this before update().
  Consistency consistency(double position, double variance, const Observation& observed) const;
  /// The correction by a code, `interval_s` after the last one.
  Update update(const Prediction& predicted, const Observation& observed, double interval_s) const;
  /// The probability outside the code's interval after the update.
  double outside(double position, double variance, const Observation& observed) const;

 private:
  bool is_fine(const CodeRange& range, double S) const;

  double quantum_;  // Δ
  EncoderRounding rounding_;
  double sensor_variance_;  // σ² and the variance of the arithmetic's error
  double noise_variance_;   // and with the added noise
  bool code_is_known_;
  double last_output_ = 0.0;
  bool has_output_ = false;
};

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
  double log_mass() const {
    return math::log(mass_) + (lower_ >= 0.0 ? -0.5 * lower_ * lower_ - math::kLogRootTwoPi : 0.0);
  }
  /// P(z < α) + P(z > β).
  double outside() const;
  /// Mean and variance of z in the interval: the moments of the truncated normal distribution,
  ///     E = (φ(α) − φ(β))/P,   Var = 1 + (α φ(α) − β φ(β))/P − E²,
  /// with an error of about 1e-16·(1 + α²)/(β − α)².
  Moments moments() const {
    const double mean = (lower_weight_ - upper_weight_) / mass_;
    return {sign_ * mean,
            1.0 + (lower_ * lower_weight_ - upper_ * upper_weight_) / mass_ - mean * mean};
  }

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
