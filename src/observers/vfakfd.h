// Variable forgetting factor-based adaptive Kalman filter (VFAKFD): thesis 4.3.1. Quantisation-
// aware variable forgetting factor (QVFF): the VFAKFD with a dead zone for the sensor's error.
#pragma once

#include <algorithm>
#include <cmath>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/kalman_estimator.h>
#include <breakwater/observers/sensor_error.h>

namespace breakwater {

/// QVFF's dead zone for noise, in σ. It also covers the error of an uncertain time.
inline constexpr double kDeadSigmas = 4.5;

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
  Vfakfd(const KalmanDesign& design, const VfakfdDesign& adaptation)
      : KalmanEstimator(design),
        lambda_min_(adaptation.lambda_min),
        lambda_max_(adaptation.lambda_max) {
    const Eigen::Index outputs = design.plant.outputs();
    refuse_unless(adaptation.alpha.size() == outputs && adaptation.dead_zone.size() == outputs &&
                      adaptation.alpha.minCoeff() > 0.0 && adaptation.dead_zone.minCoeff() >= 0.0 &&
                      adaptation.alpha.allFinite() && adaptation.dead_zone.allFinite(),
                  "VFAKFD: needs alpha > 0 and a dead zone >= 0 for each output, all finite");
    refuse_unless(lambda_min_ > 0.0 && lambda_min_ <= lambda_max_ && lambda_max_ <= 1.0,
                  "VFAKFD: needs 0 < lambda_min <= lambda_max <= 1");
    dead_zone_ = adaptation.dead_zone;
    weight_ = adaptation.alpha.cwiseSqrt().cwiseInverse();
    weighted_.setZero(outputs);
    solved_ = weighted_;
    one_plus_output_covariance_ = design.R;
    observation_covariance_.setZero(outputs, outputs);
  }

  void update(const Vector& held_input, const Vector& y) override {
    predict(held_input, y);
    if (kernel_) return correct_and_forget();
    lambda_ = std::clamp(lambda_max_ - nis(), lambda_min_, lambda_max_);
    observation_covariance_.diagonal().setConstant(lambda_);
    correct(observation_covariance_);
    covariance_ *= 1.0 / lambda_;
  }

 private:
  // For one output, with a single division: s = C̅ P C̅ᵀ, b = 1 + s and a = λ b give
  //     1/D = 1/(s + λ) = b a r   and   1/λ = b (s b + a) r   with   r = 1/(a (s b + a)).
  void correct_and_forget() {
    const double s = output_covariance_(0, 0);
    const double dead_zone = dead_zone_(0) + kDeadSigmas * instant_error_(0);
    const double error = std::max(std::abs(innovation_(0)) - dead_zone, 0.0) * weight_(0);
    const double b = 1.0 + s;
    const double a = std::clamp(lambda_max_ * b - error * error, lambda_min_ * b, lambda_max_ * b);
    const double rest = s * b + a;
    const double br = b / (a * rest);
    const double forgetting = br * rest;
    lambda_ = std::clamp(a / b, lambda_min_, lambda_max_);
    correct(lambda_, br * a, forgetting);
  }

  // ẽᵀ (I + C̅ P C̅ᵀ)⁻¹ ẽ
  double nis() {
    weighted_ = (innovation_.cwiseAbs() - dead_zone_ - kDeadSigmas * instant_error_)
                    .cwiseMax(0.0)
                    .cwiseProduct(weight_);
    weighted_ = (innovation_.array() < 0.0).select(-weighted_, weighted_);
    one_plus_output_covariance_ = output_covariance_;
    one_plus_output_covariance_.diagonal().array() += 1.0;
    factor_.compute(one_plus_output_covariance_);
    solved_ = weighted_;
    factor_.solveInPlace(solved_);
    return weighted_.dot(solved_);
  }

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
inline VfakfdDesign qvff_design(const SensorError& error) {
  check(error, error.quantum.size());
  constexpr double kQuantumThreshold = 0.5, kNoiseThreshold = 1.5;
  constexpr double kSmallestAlpha = 1e-22;  // the error of the arithmetic in place of the sensor's
  VfakfdDesign design;
  design.dead_zone = error.quantum + kDeadSigmas * error.noise_std;
  design.alpha = (kQuantumThreshold * error.quantum)
                     .cwiseAbs2()
                     .cwiseMax((kNoiseThreshold * error.noise_std).cwiseAbs2())
                     .cwiseMax(kSmallestAlpha);
  return design;
}

/// The Kalman design of a VFAKFD: Q = 0 and P0 = p0·I; R is not used.
inline KalmanDesign variable_forgetting_design(const ExtendedPlant& plant, double p0) {
  const Eigen::Index N = plant.states();
  return {plant, Eigen::MatrixXd::Zero(N, N),
          Eigen::MatrixXd::Identity(plant.outputs(), plant.outputs()),
          p0 * Eigen::MatrixXd::Identity(N, N)};
}

inline constexpr double kQvffInitialCovariance = 1e-6;

}  // namespace breakwater
