// Variable forgetting factor-based adaptive Kalman filter (VFAKFD): thesis 4.3.1.
#pragma once

#include <algorithm>
#include <cmath>

#include <breakwater/observers/kalman_estimator.h>

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
/// λ(k)·I. For p = 1 this is Eq. 4.20. The dead zone is first subtracted from |ê| (qvff.h).
template <int N = Eigen::Dynamic, int m = Eigen::Dynamic, int p = Eigen::Dynamic>
class Vfakfd final : public KalmanEstimator<N, m, p> {
 public:
  /// Throws std::invalid_argument unless α > 0, dead zone ≥ 0 and 0 < λ_min ≤ λ_max ≤ 1.
  Vfakfd(const KalmanDesign& design, const VfakfdDesign& adaptation)
      : KalmanEstimator<N, m, p>(design),
        lambda_min_(adaptation.lambda_min),
        lambda_max_(adaptation.lambda_max) {
    const Eigen::Index outputs = design.plant.outputs();
    if (adaptation.alpha.size() != outputs || adaptation.dead_zone.size() != outputs ||
        !(adaptation.alpha.minCoeff() > 0.0) || !(adaptation.dead_zone.minCoeff() >= 0.0) ||
        !adaptation.alpha.allFinite() || !adaptation.dead_zone.allFinite()) {
      throw std::invalid_argument(
          "VFAKFD: needs alpha > 0 and a dead zone >= 0 for each output, all finite");
    }
    if (!(lambda_min_ > 0.0 && lambda_min_ <= lambda_max_ && lambda_max_ <= 1.0)) {
      throw std::invalid_argument("VFAKFD: needs 0 < lambda_min <= lambda_max <= 1");
    }
    dead_zone_ = adaptation.dead_zone;
    weight_ = adaptation.alpha.cwiseSqrt().cwiseInverse();
    weighted_.setZero(outputs);
    solved_ = weighted_;
    one_plus_output_covariance_ = design.R;
    observation_covariance_ = design.R;
  }

  void update(const DisturbanceEstimator::Vector& held_input,
              const DisturbanceEstimator::Vector& y) override {
    this->predict(held_input, y);
    if constexpr (KalmanEstimator<N, m, p>::kOneOutput) {
      correct_and_forget();
      return;
    }
    this->lambda_ = std::clamp(lambda_max_ - nis(), lambda_min_, lambda_max_);
    observation_covariance_.setZero();
    observation_covariance_.diagonal().setConstant(this->lambda_);
    this->correct(observation_covariance_);
    this->covariance_ *= 1.0 / this->lambda_;
  }

 private:
  // For one output, with a single division: s = C̅ P C̅ᵀ, b = 1 + s and a = λ b give
  //     1/D = 1/(s + λ) = b a r   and   1/λ = b (s b + a) r   with   r = 1/(a (s b + a)).
  void correct_and_forget() {
    const double s = this->output_covariance_(0, 0);
    const double dead_zone = dead_zone_(0) + kInstantShare * this->instant_error_(0);
    const double error = std::max(std::abs(this->innovation_(0)) - dead_zone, 0.0) * weight_(0);
    const double b = 1.0 + s;
    const double a = std::clamp(lambda_max_ * b - error * error, lambda_min_ * b, lambda_max_ * b);
    const double rest = s * b + a;
    const double br = b / (a * rest);
    const double forgetting = br * rest;
    this->lambda_ = std::clamp(a / b, lambda_min_, lambda_max_);
    this->correct_one(this->lambda_, br * a, [forgetting](int, int) { return forgetting; });
  }

  // ẽᵀ (I + C̅ P C̅ᵀ)⁻¹ ẽ
  double nis() {
    weighted_ = (this->innovation_.cwiseAbs() - dead_zone_ - kInstantShare * this->instant_error_)
                    .cwiseMax(0.0)
                    .cwiseProduct(weight_);
    if constexpr (p == 1) {
      return weighted_(0) * weighted_(0) / (1.0 + this->output_covariance_(0, 0));
    } else {
      weighted_ = (this->innovation_.array() < 0.0).select(-weighted_, weighted_);
      one_plus_output_covariance_ = this->output_covariance_;
      one_plus_output_covariance_.diagonal().array() += 1.0;
      factor_.compute(one_plus_output_covariance_);
      solved_ = weighted_;
      factor_.solveInPlace(solved_);
      return weighted_.dot(solved_);
    }
  }

  static constexpr double kInstantShare = 4.5;  // the same factor as for σ in QVFF's dead zone

  double lambda_min_;
  double lambda_max_;
  Eigen::Matrix<double, p, 1> dead_zone_;
  Eigen::Matrix<double, p, 1> weight_;    // 1/√α
  Eigen::Matrix<double, p, 1> weighted_;  // ẽ
  Eigen::Matrix<double, p, 1> solved_;
  Eigen::Matrix<double, p, p> one_plus_output_covariance_;
  Eigen::Matrix<double, p, p> observation_covariance_;  // λ(k)·I
  Eigen::LLT<Eigen::Matrix<double, p, p>> factor_;
};

}  // namespace breakwater
