#include <breakwater/control/inverse_kinematics.h>

#include <stdexcept>

namespace breakwater {

LmInverseKinematics::LmInverseKinematics(const LmDesign& design, Eigen::Index joints)
    : design_(design),
      weighted_Jt_(joints, 3),
      normal_matrix_(joints, joints),
      factor_(joints),
      step_(Eigen::VectorXd::Zero(joints)) {
  if (!(design.weights.array() > 0.0).all() || !(design.damping > 0.0) ||
      !(design.step_limit_rad > 0.0)) {
    throw std::invalid_argument(
        "inverse kinematics: weights, damping and step limit must be positive");
  }
  if (design.form != LmForm::sugihara && joints != 3) {
    throw std::invalid_argument(
        "inverse kinematics: the printed M needs three joints; use \"sugihara\"");
  }
}

const Eigen::VectorXd& LmInverseKinematics::step(const TipJacobian& J, const TipPose& X_e) {
  weighted_Jt_.noalias() = J.transpose() * design_.weights.asDiagonal();
  normal_matrix_.noalias() = weighted_Jt_.lazyProduct(J);
  step_.noalias() = weighted_Jt_ * X_e;
  if (design_.form != LmForm::sugihara) step_ += X_e;
  if (design_.form == LmForm::printed) {
    normal_matrix_.diagonal().array() += X_e.array().abs() + design_.damping;
  } else {
    normal_matrix_.diagonal().array() +=
        0.5 * X_e.dot(design_.weights.cwiseProduct(X_e)) + design_.damping;
  }
  factor_.compute(normal_matrix_);
  factor_.solveInPlace(step_);
  step_ = step_.cwiseMax(-design_.step_limit_rad).cwiseMin(design_.step_limit_rad);
  return step_;
}

}  // namespace breakwater
