// Strong tracking filter with a gate (STF): a Kalman filter that wakes up when it is surprised.
#pragma once

#include <algorithm>
#include <cmath>

#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {

/// The Kalman design of the STF: R = Δ²/12 + σ², or Δ²/3 + σ² of an encoder that truncates (with a
/// floor), Q = 0, and
/// P0 = R/100·diag(1, …, 1, T_s⁻², …) (T_s⁻² on the disturbance and its derivatives).
KalmanDesign stf_design(const ExtendedPlant& plant, const SensorError& error, double period_s);

/// The KFD without process noise, whose covariance is inflated before the gain is computed, but
/// only if the innovation is more than the sensor's error and the estimate's own uncertainty
/// explain, however the encoder rounds (qvff.h):
///     if |ê| > Δ + 5σ + 2 √P₁₁:  P ← P · clip(4 ê²/(P₁₁ + R), 1, 1e6),   P₁₁ = C̅ P(k|k−1) C̅ᵀ.
/// After that P₁₁ + R is about 4 ê²: the innovation has become half a standard deviation. Between
/// such moments the gain fades as 1/k, and so does the noise of the estimate; a disturbance that
/// keeps changing therefore is only followed in jumps.
///
/// An inflation also raises what the outputs hardly see, and nothing takes that down again: with a
/// disturbance of order 2, P of a random plant passed 1e16 after 9e4 samples of surprises. Order 0
/// is what it is for.
///
/// For p outputs the largest factor of those whose gate is open counts. λ(k) is the factor's
/// inverse. Where the instants are uncertain, what that makes of the output counts as σ does.
template <int N = Eigen::Dynamic, int m = Eigen::Dynamic, int p = Eigen::Dynamic>
class Stf final : public KalmanEstimator<N, m, p> {
 public:
  /// Throws std::invalid_argument as stf_design() and check(SensorError) do.
  Stf(const KalmanDesign& design, const SensorError& error) : KalmanEstimator<N, m, p>(design) {
    check(error, design.plant.outputs());
    gate_ = error.quantum + kNoiseShare * error.noise_std;
  }

  void update(const DisturbanceEstimator::Vector& held_input,
              const DisturbanceEstimator::Vector& y) override {
    this->predict(held_input, y);
    const double inflation = this->inflation();
    this->lambda_ = 1.0;
    if (inflation > 1.0) {
      this->lambda_ = 1.0 / inflation;
      this->covariance_ *= inflation;
      this->compute_output_covariance();
    }
    this->correct(this->R_);
  }

 private:
  static constexpr double kNoiseShare = 5.0;
  static constexpr double kUncertaintyShare = 2.0;
  static constexpr double kInflationGain = 4.0;
  static constexpr double kLargestInflation = 1e6;

  double inflation() const {
    double factor = 1.0;
    for (Eigen::Index i = 0; i < gate_.size(); ++i) {
      const double e = std::abs(this->innovation_(i));
      const double P_ii = this->output_covariance_(i, i);
      const double gate = gate_(i) + kNoiseShare * this->instant_error_(i);
      if (e > gate + kUncertaintyShare * std::sqrt(P_ii)) {
        factor = std::max(factor, kInflationGain * e * e / (P_ii + this->R_(i, i)));
      }
    }
    return std::min(factor, kLargestInflation);
  }

  Eigen::Matrix<double, p, 1> gate_;  // Δ + 5σ
};

}  // namespace breakwater
