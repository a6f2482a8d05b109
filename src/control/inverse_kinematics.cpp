#include <breakwater/control/inverse_kinematics.h>

#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

LmInverseKinematics::LmInverseKinematics(const LmDesign& design, Eigen::Index joints)
    : design_(design),
      weighted_Jt_(joints, design.weights.size()),
      normal_matrix_(joints, joints),
      factor_(joints),
      step_(Eigen::VectorXd::Zero(joints)) {
  refuse_unless(
      (design.weights.array() > 0.0).all() && design.damping > 0.0 && design.step_limit_rad > 0.0,
      "inverse kinematics: weights, damping and step limit must be positive");
  refuse_unless(
      design.form == LmForm::sugihara || joints == design.weights.size(),
      "inverse kinematics: the printed M needs as many joints as coordinates; use \"sugihara\"");
}

const Eigen::VectorXd& LmInverseKinematics::step(const TaskJacobian& J, const TipVector& X_e) {
  with_size(X_e.size(), [&](auto c) {
    constexpr int kMost = c == Eigen::Dynamic ? 6 : c;
    using Vector = Eigen::Matrix<double, c, 1, 0, kMost, 1>;
    const Eigen::Map<const Eigen::Matrix<double, c, Eigen::Dynamic, 0, kMost, Eigen::Dynamic>> own(
        J.data(), J.rows(), J.cols());
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, c, 0, Eigen::Dynamic, kMost>> weighted(
        weighted_Jt_.data(), weighted_Jt_.rows(), weighted_Jt_.cols());
    const Vector weights = design_.weights;
    const Vector error = X_e;  // NOLINT(performance-unnecessary-copy-initialization): of fixed size
    weighted.noalias() = own.transpose() * weights.asDiagonal();
    normal_matrix_.noalias() = weighted.lazyProduct(own);
    step_.noalias() = weighted * error;
    if (design_.form != LmForm::sugihara) step_ += error;
    if (design_.form == LmForm::printed) {
      normal_matrix_.diagonal().array() += error.array().abs() + design_.damping;
    } else {
      normal_matrix_.diagonal().array() +=
          0.5 * error.dot(weights.cwiseProduct(error)) + design_.damping;
    }
  });
  factor_.compute(normal_matrix_);
  factor_.solveInPlace(step_);
  step_ = step_.cwiseMax(-design_.step_limit_rad).cwiseMin(design_.step_limit_rad);
  return step_;
}

}  // namespace breakwater
