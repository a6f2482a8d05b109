// The rotor of a motor that a model file does not have.
#pragma once

#include <mujoco/mujoco.h>

#include <string>

namespace breakwater {

/// A copy of the model with one more body in the world, behind all others, with one joint of the
/// kind of `load`. Body and joint have the name `name`. The joint has an inertia and no mass, so
/// that gravity does not act on it. In the pose of the model and in each keyframe it is at `ratio`
/// times the load's position. For mj_deleteModel().
///
/// The rotor does not move with the link that carries its motor. Its motion relative to this link
/// thus counts as its motion in the world (Spong, ASME J. Dyn. Syst. Meas. Control 109, 1987):
/// rotor and load are coupled by the transmission alone. The derived constants are not set. If the
/// engine cannot make the model, returns null and sets `fatal` to the reason.
mjModel* with_rotor(const mjModel& model, int load, double ratio, double inertia,
                    const std::string& name, std::string& fatal);

}  // namespace breakwater
