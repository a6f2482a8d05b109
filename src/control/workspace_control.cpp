#include <breakwater/control/workspace_control.h>

#include <cmath>

#include <breakwater/linear/pseudo_inverse.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

WorkspaceControl::WorkspaceControl(const ArmSetup& arm, const WorkspaceControlDesign& design)
    : ArmController(arm), design_(design), J_plus_(arm.chain->joints(), arm.chain->held()) {
  refuse_unless(design.k_p >= 0.0 && design.k_f >= 0.0 && design.singular_value_floor >= 0.0,
                "workspace control: gains must not be negative");
}

void WorkspaceControl::decide(Eigen::Ref<Eigen::VectorXd> a) {
  const bool is_hybrid = design_.law == WorkspaceLaw::hpfc;
  pseudo_inverse(J_, design_.singular_value_floor, J_plus_);
  TipVector position_error = X_ref_ - X_hat_;
  if (is_hybrid && force_control_) position_error[0] = 0.0;
  const TipVector velocity = J_ * dq_hat_;
  TipVector wanted = design_.k_p * position_error - 2.0 * std::sqrt(design_.k_p) * velocity;
  if (!is_hybrid) wanted -= chain().tip_bias_acceleration(q_hat_, dq_hat_);
  multiply(J_plus_, wanted, a);
  if (is_hybrid && force_control_) {
    a += design_.k_f * (task().force_reference_N - force_N_) * J_.row(0).transpose();
  }
}

}  // namespace breakwater
