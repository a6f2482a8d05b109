// The interface of external forces on bodies and joints, and forces that are held over a physics
// step.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>

#include <breakwater/math/interface.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// A force on bodies or joints that depends on time and state. The engine's control callback calls
/// it at every stage of the integrator, with current position and velocity quantities. It adds
/// to data.xfrc_applied (force and torque in the world frame, at the body's centre of mass) or to
/// data.qfrc_applied (force along a joint). Both are zero at first. It must not allocate, and throw
/// only RunFailure. A force with a state of its own integrates it by these stages.
class ExternalForce : public Interface {
 public:
  /// Called before the first stage of a physics step.
  virtual void begin_step() {}
  virtual void apply(double /*time_s*/, const mjModel& /*model*/, mjData& /*data*/) {}
  /// Called after the step, with the data of its last stage.
  virtual void end_step(const mjModel& /*model*/, const mjData& /*data*/) {}
};

/// A force or torque along or about a joint's axis, between the joint's body and its parent. It is
/// constant over a physics step for every integrator.
class JointForce final : public ExternalForce {
 public:
  /// Throws std::invalid_argument if the model has no hinge or slide `joint`.
  JointForce(const Model& model, const std::string& joint);

  /// Sets the force [N], or the torque [N m] of a hinge.
  void hold(double force) { force_ = force; }

  void apply(double time_s, const mjModel& model, mjData& data) override;

 private:
  int joint_;
  int dof_;
  int body_;
  bool is_from_world_;  // the body's only joint, in the world: the same as a force on the body
  int part_;            // part of the wrench: force or torque
  double force_ = 0.0;
};

/// A force at a body's centre of mass, along a direction of the world. It is constant over a
/// physics step for every integrator.
class BodyForce final : public ExternalForce {
 public:
  /// Throws std::invalid_argument if the model has no body `body`, or the direction has no length.
  BodyForce(const Model& model, const std::string& body, const Eigen::Vector3d& along);

  /// Sets the force [N].
  void hold(double force_N) { force_N_ = force_N; }

  void apply(double time_s, const mjModel& model, mjData& data) override;

 private:
  int body_;
  Eigen::Vector3d along_;
  double force_N_ = 0.0;
};

}  // namespace breakwater
