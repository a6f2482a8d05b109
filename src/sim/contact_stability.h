// The longest timestep that a contact's force allows.
#pragma once

#include <string>

#include <breakwater/sim/model.h>
#include <breakwater/world/contact_law.h>
#include <breakwater/world/wall_motion.h>

namespace breakwater {

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
