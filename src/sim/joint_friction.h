// The friction of a joint: the engine's in SI units, or any friction law.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/transmission.h>
#include <breakwater/world/friction_law.h>

namespace breakwater {

/// Sets viscous and Coulomb friction, τ_f = −c q̇ − F_C sign(q̇). Units: N s/m and N for a slide,
/// N m s/rad and N m for a hinge.
///
/// MuJoCo's dry friction is a soft constraint. Under a load F < F_C the joint creeps at F R/b with
/// R = (1 − d)/d·w and b = 2/(d·timeconst), where w is the joint's invweight0. The default
/// impedance d = 0.9 gives millimetres per second on a light cart. d = 0.9999 and a time constant
/// of two steps give micrometres per second.
///
/// Throws std::invalid_argument if a friction is negative or the joint is no slide or hinge.
void author_friction(Model& model, int joint, double viscous, double coulomb);

/// The same for each slide and hinge, with the numbers of the model file.
void author_friction(Model& model);

/// The same with the joint's own viscous friction.
void set_coulomb_friction(Model& model, int joint, double coulomb);

/// The friction of a slide or hinge, in place of a constant level of the engine's.
///
/// A law without bristles sets the level of the engine's friction constraint at each stage, so that
/// it holds the joint as Coulomb friction does. Bristles are a force that is implicit in the
/// joint's acceleration. With the step h, the velocity v and the bend z before the step it is
///     F = −(σ₀ z⁺ + σ₁ (z⁺ − z)/h) − c h q̈,   c = (σ₀ + σ₁/h) h ∂z⁺/∂u,   z⁺ = z(u = h v).
/// with z(u) of bend_after(). Where the joint may reverse within a step, a line through z⁺ = z
/// takes its place, within the range of F. The term with q̈ is a constraint of the engine's solver,
/// which also knows contacts and other joints. The force is stable for every σ₀ and step.
class JointFriction final : public ExternalForce {
 public:
  /// Gives the joint a friction constraint, as author_friction() does. The transmitted force of the
  /// law is that of the joint's actuators, and of the transmission whose load the
  /// joint is; null: none. It must outlive the friction. Throws std::invalid_argument if there is
  /// no such slide or hinge. Bristles also need a solver that reads the constraints at its call
  /// (Newton, CG).
  JointFriction(Model& model, const std::string& joint, std::unique_ptr<FrictionLaw> law,
                const Transmission* transmission = nullptr);

  void begin_step() override;
  void apply(double time_s, const mjModel& model, mjData& data) override;
  void end_step(const mjModel& model, const mjData& data) override;

  /// The force on the joint at the beginning of the last step [N or N m].
  const double& force() const { return force_; }

 private:
  void bend(mjData& data, int row);
  double transmitted(const mjData& data) const;

  std::unique_ptr<FrictionLaw> law_;
  Bristles bristles_;
  int dof_;
  int position_;  // index in qpos
  double step_s_;
  double inverse_mass_;                            // that the joint has at its model's zero
  std::vector<std::pair<int, double>> actuators_;  // that drive the joint: index, gear
  const Transmission* transmission_;

  int stage_ = 0;
  int row_ = 0;               // the friction constraint
  double applied_ = 0.0;      // part of the force that is no constraint
  double transmitted_ = 0.0;  // at the beginning of the step
  double position_then_ = 0.0;
  double z_ = 0.0;
  double force_ = 0.0;
};

}  // namespace breakwater
