// The thesis' proposed method: implicit force control with torque-limited PFC joints (2.4.2).
#pragma once

#include <vector>

#include <breakwater/control/arm_controller.h>
#include <breakwater/control/inverse_kinematics.h>
#include <breakwater/control/pfc.h>

namespace breakwater {

/// How the arm holds its start pose before force control.
enum class Positioning {
  joint,     ///< each joint to q_0^ref: fixes the posture (elbow up or down), as in 2.4.3.2
  workspace  ///< the tip to X_0^ref by inverse kinematics, as in 2.4.3.3
};

struct ImplicitForcePfcDesign {
  std::vector<Pfc> joints;  ///< one per joint
  LmDesign inverse_kinematics;
  Positioning positioning = Positioning::joint;
};

/// The system of Fig. 2.43. Implicit force control converts the force error into a position error
/// of the tip. LM inverse kinematics converts this into errors of the joint angles, and a PFC into
/// accelerations. The torque limits bound these accelerations (Eq. 2.84).
class ImplicitForcePfc final : public ArmController {
 public:
  /// Throws std::invalid_argument as the parts do, or if there is not one PFC per joint.
  ImplicitForcePfc(const ArmSetup& arm, const ImplicitForcePfcDesign& design);

 private:
  void decide(Eigen::Ref<Eigen::VectorXd> a) override;

  ImplicitForcePfcDesign design_;
  LmInverseKinematics inverse_kinematics_;
  Eigen::VectorXd q_ref_;
};

}  // namespace breakwater
