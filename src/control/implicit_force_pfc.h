// The thesis' proposed method: implicit force control over torque-limited PFC joints (2.4.2).
#pragma once

#include <vector>

#include <breakwater/control/arm_controller.h>
#include <breakwater/control/inverse_kinematics.h>
#include <breakwater/control/pfc.h>

namespace breakwater {

/// How the arm holds its start pose before force control, and throughout if there is none.
enum class Positioning {
  joint,     ///< each joint to q_0^ref: fixes the posture (elbow up or down), as in 2.4.3.2
  workspace  ///< the tip to X_0^ref by inverse kinematics, as in 2.4.3.3
};

struct ImplicitForcePfcDesign {
  std::vector<PfcDesign> joints;  ///< one per joint
  LmDesign inverse_kinematics;
  Positioning positioning = Positioning::joint;
};

/// Force error → tip position error (implicit force control) → joint angle error (LM inverse
/// kinematics) → joint acceleration (PFC), clipped so that the torque stays within its limits
/// (Eq. 2.84): the system of Fig. 2.43.
class ImplicitForcePfc final : public ArmController {
 public:
  /// Throws std::invalid_argument where the parts do, or if there is not one PFC per joint.
  ImplicitForcePfc(const PlanarChain& chain, const AccelerationControlDesign& acceleration,
                   const ArmTask& task, const ImplicitForcePfcDesign& design);

 private:
  void decide(Eigen::Ref<Eigen::VectorXd> a) override;

  std::vector<Pfc> pfc_;
  LmInverseKinematics inverse_kinematics_;
  Positioning positioning_;
  Eigen::VectorXd q_ref_;
};

}  // namespace breakwater
