// Variable forgetting factor-based adaptive Kalman filter (VFAKFD): thesis 4.3.1. Quantisation-
// aware variable forgetting factor (QVFF): the VFAKFD with a dead zone for the sensor's error.
#pragma once

#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {

struct VfakfdDesign {
  Eigen::VectorXd alpha;      ///< α > 0 for each output, in its unit squared
  Eigen::VectorXd dead_zone;  ///< for each innovation, in the output's unit; 0 in the thesis
  double lambda_min = 0.8;
  double lambda_max = 1.0;
};

/// Eq. 4.26: α = 1/(b_reso T_s), with the encoder's pulses per revolution.
inline double vfakfd_alpha(double pulses_per_revolution, double period_s) {
  return 1.0 / (pulses_per_revolution * period_s);
}

/// The KFD with a forgetting factor that depends on the innovation (Eqs. 4.18–4.21):
///     λ(k) = λ_max − 1/(1 + C̅ P(k|k−1) C̅ᵀ) · ê²(k)/α,  kept within [λ_min, λ_max],
///     D(k) = C̅ P(k|k−1) C̅ᵀ + λ(k),
///     P(k|k) = λ⁻¹(k) (I − K(k) C̅) P(k|k−1).
/// Both places use λ(k) of the current innovation. The design's R is not used.
///
/// For p outputs, with ẽ_i = ê_i/√α_i: λ(k) = λ_max − ẽᵀ (I + C̅ P C̅ᵀ)⁻¹ ẽ and D(k) = C̅ P C̅ᵀ +
/// λ(k)·I. For p = 1 this is Eq. 4.20. The dead zone is first subtracted from |ê| (qvff_design()).
class Vfakfd final : public KalmanEstimator {
 public:
  /// Throws std::invalid_argument unless α > 0, dead zone ≥ 0 and 0 < λ_min ≤ λ_max ≤ 1.
  Vfakfd(const KalmanDesign& design, const VfakfdDesign& adaptation);

  void update(const Vector& held_input, const Vector& y) override;

 private:
  void correct_and_forget();
  double nis();

  double lambda_min_;
  double lambda_max_;
  Eigen::VectorXd dead_zone_;
  Eigen::VectorXd weight_;    // 1/√α
  Eigen::VectorXd weighted_;  // ẽ
  Eigen::VectorXd solved_;
  Eigen::MatrixXd one_plus_output_covariance_;
  Eigen::MatrixXd observation_covariance_;  // λ(k)·I
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// QVFF subtracts the sensor's own error from ê, so that λ(k) reacts to small errors:
///     |ê| → max(0, |ê| − Δ − 4.5 σ),   α = max((Δ/2)², (1.5 σ)², α_floor),   P0 = 1e-6·I.
/// P0 is a number without a unit, against R = 1: the estimate depends on the unit of the position.
/// Derivation and limits: docs/explanation/methods/disturbance-kalman-filters.md.
///
/// Throws as check(SensorError) does.
VfakfdDesign qvff_design(const SensorError& error);

/// The Kalman design of a VFAKFD: Q = 0 and P0 = p0·I; R is not used.
KalmanDesign variable_forgetting_design(const ExtendedPlant& plant, double p0);

constexpr double kQvffInitialCovariance = 1e-6;

}  // namespace breakwater
