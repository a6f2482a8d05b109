#include <breakwater/control/workspace_control.h>

#include <cmath>

#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

const WorkspaceControlDesign& checked(const WorkspaceControlDesign& design) {
  refuse_unless(design.k_p >= 0.0 && design.k_f >= 0.0 && design.singular_value_floor >= 0.0,
                "workspace control: gains must not be negative");
  return design;
}

}  // namespace

Hpfc::Hpfc(const ArmSetup& arm, const WorkspaceControlDesign& design)
    : ArmController(arm),
      design_(checked(design)),
      J_plus_(arm.chain->joints(), arm.chain->held()) {}

void Hpfc::decide(Eigen::Ref<Eigen::VectorXd> a) {
  pseudo_inverse(J_, design_.singular_value_floor, J_plus_);
  TipVector position_error = task().start_pose - X_hat_;
  if (force_control_) position_error[0] = 0.0;
  const TipVector velocity = J_ * dq_hat_;
  const TipVector wanted = design_.k_p * position_error - 2.0 * std::sqrt(design_.k_p) * velocity;
  multiply(J_plus_, wanted, a);
  if (force_control_) {
    a += design_.k_f * (task().force_reference_N - force_N_) * J_.row(0).transpose();
  }
}

Drac::Drac(const ArmSetup& arm, const WorkspaceControlDesign& design)
    : ArmController(arm),
      design_(checked(design)),
      J_plus_(arm.chain->joints(), arm.chain->held()) {}

void Drac::decide(Eigen::Ref<Eigen::VectorXd> a) {
  pseudo_inverse(J_, design_.singular_value_floor, J_plus_);
  const TipVector velocity = J_ * dq_hat_;
  const TipVector bias = chain().tip_bias_acceleration(q_hat_, dq_hat_);
  const TipVector wanted =
      design_.k_p * (X_ref_ - X_hat_) - 2.0 * std::sqrt(design_.k_p) * velocity - bias;
  multiply(J_plus_, wanted, a);
}

}  // namespace breakwater
