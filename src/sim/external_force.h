// The interface of external forces on bodies and joints.
#pragma once

#include <mujoco/mujoco.h>

namespace breakwater {

/// A force on bodies or joints that depends on time and state. The engine's control callback calls
/// it at every stage of the integrator, with current position and velocity quantities. It adds
/// to data.xfrc_applied (force and torque in the world frame, at the body's centre of mass) or to
/// data.qfrc_applied (force along a joint). Both are zero at first. It must not throw, allocate or
/// keep state.
class ExternalForce {
 public:
  ExternalForce() = default;
  ExternalForce(const ExternalForce&) = delete;
  ExternalForce& operator=(const ExternalForce&) = delete;
  virtual ~ExternalForce() = default;

  virtual void apply(double time_s, const mjModel& model, mjData& data) const = 0;
};

/// A force with a state of its own, which it integrates by the stages of the engine's integrator.
/// Must not allocate.
class StagedForce {
 public:
  StagedForce() = default;
  StagedForce(const StagedForce&) = delete;
  StagedForce& operator=(const StagedForce&) = delete;
  virtual ~StagedForce() = default;

  /// Called before the first stage of a physics step.
  virtual void begin_step() = 0;
  /// Called at each stage, like ExternalForce::apply(). May throw RunFailure.
  virtual void apply(double time_s, const mjModel& model, mjData& data) = 0;
  /// Called after the step, with the data of its last stage.
  virtual void end_step(const mjData& data) = 0;
};

}  // namespace breakwater
