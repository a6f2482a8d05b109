// Forgetting factor-based adaptive Kalman filter (FAKFD): thesis 4.2.3.
#pragma once

#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/kalman_estimator.h>

namespace breakwater {

/// Γ = γ·I: all states forget (Eq. 4.6). λ = 1/γ.
inline Eigen::VectorXd scalar_gamma(const ExtendedPlant& plant, double gamma) {
  return Eigen::VectorXd::Constant(plant.states(), gamma);
}

/// Γ = diag(I, γ_d): only the disturbance and its derivatives forget (Eq. 4.7).
inline Eigen::VectorXd diagonal_gamma(const ExtendedPlant& plant, double gamma_d) {
  Eigen::VectorXd gamma = Eigen::VectorXd::Constant(plant.states(), gamma_d);
  gamma.head(plant.plant_states).setOnes();
  return gamma;
}

/// The form of P(k|k) in Eq. 4.5 for a matrix Γ (Eq. 4.7).
enum class CovarianceForm {
  symmetric,  ///< √Γ (I − K C̅) P(k|k−1) √Γ
  printed,    ///< (Γ − K C̅) P(k|k−1)
  left        ///< Γ (I − K C̅) P(k|k−1)
};

/// A KFD with a constant forgetting factor. It inflates the covariance after each measurement. With
/// Γ = γ·I all forms are Eq. 4.18. For other diagonal Γ the printed and the left one are not
/// symmetric, and their P is no covariance. With one output:
///     K(k) = P(k|k−1) C̅ᵀ / (C̅ P(k|k−1) C̅ᵀ + R).
class Fakfd final : public KalmanEstimator {
 public:
  /// `gamma` is the diagonal of Γ. Throws std::invalid_argument unless it has N entries from 1 to
  /// 1e6, with which the covariance does not overflow. An asymmetric form needs one output.
  Fakfd(const KalmanDesign& design, const Eigen::VectorXd& gamma,
        CovarianceForm form = CovarianceForm::symmetric)
      : KalmanEstimator(design, form == CovarianceForm::symmetric), gamma_(gamma), form_(form) {
    refuse_unless(gamma.size() == design.plant.states() &&
                      (gamma.array() >= 1.0 && gamma.array() <= 1e6).all(),
                  "FAKFD: needs one factor gamma from 1 to 1e6 for each extended state");
    refuse_unless(form == CovarianceForm::symmetric || design.plant.outputs() == 1,
                  "FAKFD: Eq. 4.5 as printed needs a plant with one output");
    const Eigen::VectorXd root = gamma.cwiseSqrt();
    inflation_ = root * root.transpose();
    lambda_ = 1.0 / gamma.maxCoeff();
  }

  void update(const Vector& held_input, const Vector& y) override {
    predict(held_input, y);
    if (form_ == CovarianceForm::symmetric) {
      correct(R_);
      covariance_ = covariance_.cwiseProduct(inflation_);
      return;
    }
    gain_.noalias() = covariance_ * C_.transpose();
    gain_ /= output_covariance_(0, 0) + R_(0, 0);
    extended_state_.noalias() += gain_ * innovation_;
    if (form_ == CovarianceForm::printed) inflate();
    covariance_.noalias() -= gain_ * output_cross_;
    if (form_ == CovarianceForm::left) inflate();
  }

 private:
  void inflate() { covariance_.array().colwise() *= gamma_.array(); }

  Eigen::VectorXd gamma_;
  CovarianceForm form_;
  Eigen::MatrixXd inflation_;  // √γ_i √γ_j
};

}  // namespace breakwater
