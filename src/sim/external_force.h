// What pushes on bodies from outside.
#pragma once

#include <mujoco/mujoco.h>

namespace breakwater {

/// A force on bodies that depends on time and state. Called inside the engine's control callback,
/// with position and velocity quantities fresh, at every stage of the integrator; it adds to
/// data.xfrc_applied (force, torque in the world frame, at the body's centre of mass), which has
/// been zeroed. Must not throw, allocate or keep state.
class ExternalForce {
 public:
  ExternalForce() = default;
  ExternalForce(const ExternalForce&) = delete;
  ExternalForce& operator=(const ExternalForce&) = delete;
  virtual ~ExternalForce() = default;

  virtual void apply(double time_s, const mjModel& model, mjData& data) const = 0;
};

}  // namespace breakwater
