// A force along a joint's axis.
#pragma once

#include <string>

#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// Applies a force or torque to a joint's body, along or about the joint's axis. It is constant
/// over a physics step for every integrator.
class JointForce final : public ExternalForce {
 public:
  /// Throws std::invalid_argument if the model has no joint `joint`.
  JointForce(const Model& model, const std::string& joint);

  /// Sets the force [N], or the torque [N m] of a hinge.
  void hold(double force) { force_ = force; }

  void apply(double time_s, const mjModel& model, mjData& data) const override;

 private:
  int joint_;
  int body_;
  int part_;  // part of the wrench: force or torque
  double force_ = 0.0;
};

}  // namespace breakwater
