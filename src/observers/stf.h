// Strong tracking filter (STF): a large innovation raises the covariance of a Kalman filter.
#pragma once

#include <algorithm>
#include <cmath>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {

/// The Kalman design of the STF: Q = 0, and R = Δ²/12 + σ² (Δ²/3 + σ² for an encoder that
/// truncates) with a floor. P0 = R/100·diag(1, …, 1, T_s⁻², …), with T_s⁻² for the disturbance and
/// its derivatives.
inline KalmanDesign stf_design(const ExtendedPlant& plant, const SensorError& error,
                               double period_s) {
  check(error, plant.outputs());
  refuse_unless(period_s > 0.0, "STF: the sampling period must be positive");
  const Eigen::VectorXd variance = error.variance().cwiseMax(kSmallestVariance);
  constexpr double kPriorShare = 0.01;
  Eigen::VectorXd prior =
      Eigen::VectorXd::Constant(plant.states(), kPriorShare * variance.maxCoeff());
  prior.tail(plant.states() - plant.plant_states) /= period_s * period_s;
  return {plant, Eigen::MatrixXd::Zero(plant.states(), plant.states()), variance.asDiagonal(),
          prior.asDiagonal()};
}

/// A KFD without process noise. It inflates the covariance before the gain if the innovation leaves
/// a gate. The gate covers the sensor's error and the estimate's own uncertainty, for rounding and
/// truncation (vfakfd.h):
///     if |ê| > Δ + 5σ + 2 √P₁₁:  P ← P · clip(4 ê²/(P₁₁ + R), 1, 1e6),   P₁₁ = C̅ P(k|k−1) C̅ᵀ.
/// P₁₁ + R is then about 4 ê²: the innovation is half a standard deviation. Between the inflations
/// the gain and the noise of the estimate fall as 1/k. A disturbance that keeps changing is
/// therefore followed only in jumps.
///
/// An inflation also raises covariances that the outputs hardly depend on, and nothing reduces them
/// again. With a disturbance of order 2, P of a random plant exceeded 1e16 after 9e4 samples with
/// such innovations. Use order 0.
///
/// For p outputs, the largest factor among the open gates applies. λ(k) is its inverse. If the
/// sample times are uncertain, the resulting output error counts as σ does.
class Stf final : public KalmanEstimator {
 public:
  /// Throws as stf_design() and check(SensorError) do.
  Stf(const KalmanDesign& design, const SensorError& error) : KalmanEstimator(design) {
    check(error, design.plant.outputs());
    gate_ = error.quantum + kNoiseShare * error.noise_std;
  }

  void update(const Vector& held_input, const Vector& y) override {
    predict(held_input, y);
    const double factor = inflation();
    lambda_ = 1.0 / factor;
    if (factor > 1.0) {
      covariance_ *= factor;
      compute_output_covariance();
    }
    correct(R_);
  }

 private:
  static constexpr double kNoiseShare = 5.0;

  double inflation() const {
    constexpr double kUncertaintyShare = 2.0, kInflationGain = 4.0, kLargestInflation = 1e6;
    double factor = 1.0;
    for (Eigen::Index i = 0; i < gate_.size(); ++i) {
      const double e = std::abs(innovation_(i));
      const double P_ii = output_covariance_(i, i);
      const double gate = gate_(i) + kNoiseShare * instant_error_(i);
      if (e > gate + kUncertaintyShare * std::sqrt(P_ii)) {
        factor = std::max(factor, kInflationGain * e * e / (P_ii + R_(i, i)));
      }
    }
    return std::min(factor, kLargestInflation);
  }

  Eigen::VectorXd gate_;  // Δ + 5σ
};

}  // namespace breakwater
