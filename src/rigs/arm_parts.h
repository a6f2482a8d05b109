// The parts of a scenario with the arm: what the catalogue's controllers are told.
#pragma once

#include <vector>

#include <breakwater/control/arm_controller.h>
#include <breakwater/experiment/parts.h>

namespace breakwater {

/// What a controller of the arm is told: all but how the arm and the wall really are.
struct ArmSetup {
  PlanarChain chain;                       ///< of the URDF
  AccelerationControlDesign acceleration;  ///< of the joints' control, with its observer
  ArmTask task;                            ///< what to do, and from when on to control the force
  double period_s = 0.0;                   ///< T_s, of the samples
};

/// A controller of the arm by its name: key controller.name. It gets samples [q (n) [rad]; F_x [N];
/// F_x before the sensor's low-pass [N]] and writes n torques [N m]; F_x is positive when the tip
/// presses towards +x. One that derives from ArmController gives accelerations instead, and has the
/// disturbance observer, the kinematics and the phases there.
struct ArmControllerKind : PartKind<Controller, const ArmSetup&> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "controller of the arm";
};

/// Breakwater's own.
std::vector<ArmControllerKind> arm_controllers();

}  // namespace breakwater
