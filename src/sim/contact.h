// Contacts: their parameters in SI units, and the force between two geoms.
#pragma once

#include <string>

#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>

namespace breakwater {

/// Parameters of a contact.
struct ContactLaw {
  double stiffness_N_m = 0.0;  ///< K: the static depth under a force F is F/K
  double damping_Ns_m = 0.0;   ///< B: the force is K·depth + B·(approach velocity) ≥ 0
};

/// Makes the contact of two frictionless geoms obey `law`, by their solref and solimp. At least one
/// of them must be able to move.
///
/// MuJoCo's constraint force is f = (a_ref − a₁)/R with a_ref = −b v − k d r and R = (1 − d)/d·w. r
/// is the (negative) gap, v its rate, a₁ the acceleration left in the contact and d the impedance.
/// w is the sum of the bodies' translational body_invweight0. With a constant d, solref = (−K w
/// (1−d), −B w (1−d)) gives k d/R = K and b/R = B exactly. The remaining −a₁/R acts as an added
/// mass d/((1−d) w), which is negligible for d = 0.001.
///
/// Throws std::invalid_argument unless K > 0, B ≥ 0 and one body can move. Both geoms must have
/// condim 1, no margin, no gap, the same priority and no <pair>.
void author_contact(Model& model, int geom1, int geom2, const ContactLaw& law);

/// Moves the geom `wall`, a plane of the world body, to x. All geoms of that body with a name that
/// begins with `wall_` move too. Throws std::invalid_argument if there is no such plane.
void place_wall(Model& model, const std::string& wall, double x_m);

/// Turns that plane, together with the same geoms, about the vertical through its own position,
/// counter-clockwise seen from above. Throws as place_wall().
void tilt_wall(Model& model, const std::string& wall, double angle_rad);

/// Two geoms that may touch by the engine's contact, which is measured in each step.
class GeomContact final : public StagedForce {
 public:
  /// Throws std::invalid_argument if the model lacks one of them.
  GeomContact(const Model& model, const std::string& geom_1, const std::string& geom_2);

  /// The sum of the normal forces of all their contacts [N], as the engine computed it last.
  double force_N(const mjModel& model, const mjData& data) const;
  /// The same of the last step.
  const double& force_N() const { return force_N_; }

  void begin_step() override {}
  void apply(double, const mjModel& model, mjData&) override { model_ = &model; }
  void end_step(const mjData& data) override { force_N_ = force_N(*model_, data); }

 private:
  int geom_1_;
  int geom_2_;
  const mjModel* model_ = nullptr;
  double force_N_ = 0.0;
};

}  // namespace breakwater
