// A force on a body.
#pragma once

#include <Eigen/Core>
#include <string>

#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// A force at a body's centre of mass, along a direction of the world. It is constant over a
/// physics step for every integrator.
class BodyForce final : public ExternalForce {
 public:
  /// Throws std::invalid_argument if the model has no body `body`, or the direction has no length.
  BodyForce(const Model& model, const std::string& body, const Eigen::Vector3d& along);

  /// Sets the force [N].
  void hold(double force_N) { force_N_ = force_N; }

  void apply(double time_s, const mjModel& model, mjData& data) const override;

 private:
  int body_;
  Eigen::Vector3d along_;
  double force_N_ = 0.0;
};

}  // namespace breakwater
