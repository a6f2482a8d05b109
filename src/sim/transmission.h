// A transmission between a motor joint and a load joint.
#pragma once

#include <string>

#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// Units: N m/rad, N m s/rad and rad at the load if it turns, N/m, N s/m and m if it slides.
struct TransmissionDesign {
  double ratio = 1.0;            ///< N: motion of the motor for one of the load, not 0
  double stiffness = 0.0;        ///< K > 0
  double damping = 0.0;          ///< D ≥ 0
  double backlash = 0.0;         ///< b ≥ 0: play of the load while the motor stands
  double kinematic_error = 0.0;  ///< e: amplitude of the error, at the load
  double error_per_turn = 1.0;   ///< n: its periods in one turn (2π) of the motor
};

/// A spring and a damper between two joints. The twist at the load is
///     φ = q_m/N + e sin(n q_m) − q_l,
/// and the torque T on the load is
///     T = K z + D φ̇ with z = φ − b/2 for φ > b/2, φ + b/2 for φ < −b/2,
/// and 0 between, in the play. With a backlash, T never pulls: T z ≥ 0. The motor bears −T ∂φ/∂q_m,
/// so that the transmission stores energy only in its spring and loses energy only in its damper.
class Transmission final : public ExternalForce {
 public:
  /// Throws std::invalid_argument if a number is not in its range, or if a joint is missing or is
  /// no slide or hinge.
  Transmission(const Model& model, const std::string& motor, const std::string& load,
               const TransmissionDesign& design);

  /// Throws std::invalid_argument if the model's integrator is not stable on the spring between the
  /// inertias of the model's own pose. The message has the longest stable timestep.
  void check_stability(const Model& model) const;

  void apply(double time_s, const mjModel& model, mjData& data) override;

  /// φ and T in a state.
  double twist(double motor, double load) const;
  double torque(double motor, double motor_rate, double load, double load_rate) const;
  /// T in a state of the engine.
  double torque(const double* qpos, const double* qvel) const;

 private:
  double slope(double motor) const;  // ∂φ/∂q_m

  TransmissionDesign design_;
  int motor_;  // indices in qpos, and of the degrees of freedom
  int load_;
  int motor_dof_;
  int load_dof_;
};

}  // namespace breakwater
