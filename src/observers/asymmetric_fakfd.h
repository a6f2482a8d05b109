// The FAKFD with Eq. 4.5 as it is printed.
#pragma once

#include <breakwater/observers/fakfd.h>

namespace breakwater {

/// The form of P(k|k) in Eq. 4.5 for a matrix Γ (Eq. 4.7).
enum class CovarianceForm {
  symmetric,  ///< √Γ (I − K C̅) P(k|k−1) √Γ: Fakfd
  printed,    ///< (Γ − K C̅) P(k|k−1)
  left        ///< Γ (I − K C̅) P(k|k−1)
};

/// The KFD with one of the two asymmetric forms, whose P is no covariance. With one output:
///     K(k) = P(k|k−1) C̅ᵀ / (C̅ P(k|k−1) C̅ᵀ + R).
class AsymmetricFakfd final : public KalmanEstimator {
 public:
  /// Throws as Fakfd does, and std::invalid_argument for more than one output.
  AsymmetricFakfd(const KalmanDesign& design, const Eigen::VectorXd& gamma, CovarianceForm form)
      : KalmanEstimator(design, false),
        gamma_(gamma),
        inflates_correction_(form == CovarianceForm::left) {
    check_factors(design, gamma);
    if (design.plant.outputs() != 1) {
      throw std::invalid_argument("FAKFD: Eq. 4.5 as printed needs a plant with one output");
    }
    lambda_ = 1.0 / gamma.maxCoeff();
    output_cross_.setZero(1, gamma.size());
  }

  void update(const Vector& held_input, const Vector& y) override {
    predict(held_input, y);
    gain_.noalias() = covariance_ * C_.transpose();
    gain_ /= output_covariance_(0, 0) + R_(0, 0);
    extended_state_.noalias() += gain_ * innovation_;
    output_cross_.noalias() = C_ * covariance_;
    if (!inflates_correction_) inflate();
    covariance_.noalias() -= gain_ * output_cross_;
    if (inflates_correction_) inflate();
  }

 private:
  void inflate() { covariance_.array().colwise() *= gamma_.array(); }

  Eigen::VectorXd gamma_;
  bool inflates_correction_;
  Eigen::MatrixXd output_cross_;  // C̅ P(k|k−1)
};

}  // namespace breakwater
