// Contacts: their parameters in SI units, the force between two geoms, and the longest timestep
// that a contact's force allows.
#pragma once

#include <string>

#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>
#include <breakwater/world/contact_law.h>
#include <breakwater/world/wall_motion.h>

namespace breakwater {

/// Makes the contact of two frictionless geoms obey `law` with its K and B, by their solref and
/// solimp. At least one of them must be able to move.
///
/// MuJoCo's constraint force is f = (a_ref − a₁)/R with a_ref = −b v − k d r and R = (1 − d)/d·w. r
/// is the (negative) gap, v its rate, a₁ the acceleration left in the contact and d the impedance.
/// w is the sum of the bodies' translational body_invweight0. With a constant d, solref = (−K w
/// (1−d), −B w (1−d)) gives k d/R = K and b/R = B exactly. The remaining −a₁/R acts as an added
/// mass d/((1−d) w), which is negligible for d = 0.001.
///
/// Throws std::invalid_argument unless one body can move. Both geoms must have condim 1, no margin,
/// no gap, the same priority and no <pair>.
void author_contact(Model& model, int geom1, int geom2, const KelvinVoigt& law);

/// The id of a plane of the world body. Throws std::invalid_argument if there is no such plane.
int world_plane(const Model& model, const std::string& wall);

/// Moves the geom `wall`, a plane of the world body, to x. All geoms of that body with a name that
/// begins with `wall_` move too. Throws std::invalid_argument if there is no such plane.
void place_wall(Model& model, const std::string& wall, double x_m);

/// Turns that plane, together with the same geoms, about an axis in it through its own position.
/// This axis is the one nearest to the vertical, counter-clockwise seen from above. A horizontal
/// plane turns about its y axis. Throws as place_wall().
void tilt_wall(Model& model, const std::string& wall, double angle_rad);

/// Two geoms that may touch by the engine's contact, which is measured in each step.
class GeomContact final : public ExternalForce {
 public:
  /// Throws std::invalid_argument if the model lacks one of them.
  GeomContact(const Model& model, const std::string& geom_1, const std::string& geom_2);

  /// The sum of the normal forces of all their contacts [N], as the engine computed it last.
  double force_N(const mjModel& model, const mjData& data) const;
  /// The same of the last step.
  const double& force_N() const { return force_N_; }

  void end_step(const mjModel& model, const mjData& data) override {
    force_N_ = force_N(model, data);
  }

 private:
  int geom_1_;
  int geom_2_;
  double force_N_ = 0.0;
};

/// A contact's local behaviour: m ẍ = −k x − c ẋ.
struct ContactSlopes {
  double stiffness_N_m = 0.0;   ///< k = ∂F/∂x ≥ 0
  double damping_Ns_m = 0.0;    ///< c = ∂F/∂ẋ ≥ 0
  double mass_kg = 1.0;         ///< m, which may be infinite
  double relaxation_1_s = 0.0;  ///< the fastest rate at which the law's own state decays
};

/// The slopes of a law at a penetration [m] and a speed [m/s], by difference quotients.
ContactSlopes slopes_of(const ContactForceLaw& law, const ContactState& state, double penetration_m,
                        double speed_m_s, double mass_kg);

/// The slopes of a contact with a wall that may be free. The mass is then that of both bodies,
/// 1/(1/m + 1/M). The wall's own spring and damper are added with their part of this mass, so the
/// limit is on the safe side.
ContactSlopes with_wall(ContactSlopes slopes, const WallMotion& wall);

/// Whether the integrator is stable on it with the timestep h. The relaxation needs
/// h relaxation < 2. The motion needs, with
/// - Euler and implicit, which take a force from outside at the step's beginning:
///       h² k/m + 2 h c/m < 4;
/// - RK4: |R(h λ)| ≤ 1 with R(z) = 1 + z + z²/2 + z³/6 + z⁴/24 for both roots λ of
///       λ² + c/m λ + k/m = 0; without damping this is h < 2.83 √(m/k).
bool is_stable(Integrator integrator, double timestep_s, const ContactSlopes& slopes);

/// The longest stable timestep [s]; infinite if there is none.
double longest_stable_timestep_s(Integrator integrator, const ContactSlopes& slopes);

/// The longest stable timestep of which an unstable timestep is a multiple [s].
double dividing_timestep_s(Integrator integrator, double timestep_s, const ContactSlopes& slopes);

/// Says why an unstable timestep is refused: "a stiffness of 4e+09 N/m ... are beyond the stability
/// limit ...; the longest stable physics.timestep_s that divides it is 3.125e-05". The control
/// period is a multiple of this timestep too.
std::string limit_in_words(Integrator integrator, double timestep_s, const ContactSlopes& slopes);

}  // namespace breakwater
