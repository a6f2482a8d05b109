// The interface between a scenario with the arm and its controllers.
#pragma once

#include <vector>

#include <breakwater/control/arm_controller.h>
#include <breakwater/experiment/parts.h>

namespace breakwater {

/// A controller of the arm and its name: key controller.name. It gets samples [q (n) [rad]; F_x
/// [N]; F_x before the sensor's low-pass [N]] and writes n torques [N m]. F_x is positive when the
/// tip presses towards +x. A class that derives from ArmController gives accelerations instead. It
/// has the disturbance observer, the kinematics and the phases there.
struct ArmControllerKind : PartKind<Controller, const ArmSetup&> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "controller of the arm";
};

/// The controllers of Breakwater.
std::vector<ArmControllerKind> arm_controllers();

}  // namespace breakwater
