#include <breakwater/control/implicit_force_pfc.h>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

ImplicitForcePfc::ImplicitForcePfc(const ArmSetup& arm, const ImplicitForcePfcDesign& design)
    : ArmController(arm),
      design_(design),
      inverse_kinematics_(design.inverse_kinematics, arm.chain->joints()),
      q_ref_(arm.task.start_angles_rad) {
  refuse_unless(static_cast<Eigen::Index>(design.joints.size()) == arm.chain->joints(),
                "implicit force PFC: needs one PFC per joint");
  publish({"q_ref_rad", "rad", "joint angle references (Eq. 2.63)", view(q_ref_)});
}

void ImplicitForcePfc::decide(Eigen::Ref<Eigen::VectorXd> a) {
  if (force_control_ || design_.positioning == Positioning::workspace) {
    q_ref_ = q_hat_ + inverse_kinematics_.step(J_, X_ref_ - X_hat_);
  } else {
    q_ref_ = task().start_angles_rad;
  }
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    a(i) =
        design_.joints[static_cast<std::size_t>(i)].acceleration(q_ref_(i), q_hat_(i), dq_hat_(i));
  }
  joints().limit(a);
}

}  // namespace breakwater
