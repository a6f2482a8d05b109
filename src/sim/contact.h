// Contact authored in SI units.
#pragma once

#include <string>

#include <breakwater/sim/model.h>

namespace breakwater {

/// What a user knows of a contact.
struct ContactLaw {
  double stiffness_N_m = 0.0;  ///< K: the static depth under a force F is F/K
  double damping_Ns_m = 0.0;   ///< B: the force is K·depth + B·(speed of approach), never a pull
};

/// Makes the contact of two frictionless geoms, of which at least one moves, obey `law`, by
/// compiling it to both geoms' solref and solimp.
///
/// MuJoCo's constraint force is f = (a_ref − a₁)/R with a_ref = −b v − k d r and
/// R = (1 − d)/d·w, where r is the (negative) gap, v its rate, a₁ the acceleration left in the
/// contact, d the impedance and w the bodies' summed translational body_invweight0. With a constant
/// d, solref = (−K w (1−d), −B w (1−d)) gives k d/R = K and b/R = B exactly. The remaining −a₁/R
/// acts as an added mass d/((1−d) w), which a small d = 0.001 makes negligible.
///
/// Throws std::invalid_argument if K is not positive, B is negative, a geom has friction
/// dimensions (condim other than 1), a margin or a gap, their priorities differ, a <pair> names one
/// of them, or neither body can move.
void author_contact(Model& model, int geom1, int geom2, const ContactLaw& law);

/// Moves a plane of the world body, the geom `wall`, to x, together with all geoms whose names
/// begin with its. Throws std::invalid_argument if there is no such plane.
void place_wall(Model& model, const std::string& wall, double x_m);

/// Turns that plane, together with the same geoms, about the vertical through its own position,
/// counter-clockwise seen from above. Throws as place_wall().
void tilt_wall(Model& model, const std::string& wall, double angle_rad);

}  // namespace breakwater
