// A force along a joint's axis.
#pragma once

#include <string>

#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// Pushes a joint's body along the joint's axis, or turns it about a hinge's, with what it was last
/// told to hold: over a physics step the force is constant, whatever the integrator.
class JointForce final : public ExternalForce {
 public:
  /// Throws std::invalid_argument if the model has no joint of that name.
  JointForce(const Model& model, const std::string& joint);

  /// A force [N], or of a hinge a torque [N m].
  void hold(double force) { force_ = force; }

  void apply(double time_s, const mjModel& model, mjData& data) const override;

 private:
  int joint_;
  int body_;
  int part_;  // of the wrench: force or torque
  double force_ = 0.0;
};

}  // namespace breakwater
