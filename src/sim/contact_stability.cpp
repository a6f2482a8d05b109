#include <breakwater/sim/contact_stability.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iomanip>
#include <limits>
#include <sstream>

namespace breakwater {
namespace {

constexpr double kLimit = 4.0;  // h² k/m + 2 h c/m
constexpr double kFirstOrderLimit = 2.0;

constexpr double kSmallStep = 1e-6;     // step of a difference quotient, relative to a length ...
constexpr double kSmallDepth_m = 1e-6;  // ... that is at least this

// |R(z)|²
double growth_squared(double re, double im) {
  const std::complex<double> z(re, im);
  return std::norm(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))));
}

}  // namespace

ContactSlopes slopes_of(const ContactForceLaw& law, const ContactState& state, double penetration_m,
                        double speed_m_s, double mass_kg) {
  ContactState here = state;
  const double force_N = law.force(penetration_m, speed_m_s, here);
  const auto slope = [&](double dx, double dv) {
    ContactState there = state;
    return (law.force(penetration_m + dx, speed_m_s + dv, there) - force_N) / (dx + dv);
  };
  ContactSlopes slopes;
  slopes.mass_kg = mass_kg;
  slopes.stiffness_N_m = std::max(slope(kSmallStep * (kSmallDepth_m + penetration_m), 0.0), 0.0);
  slopes.damping_Ns_m = std::max(slope(0.0, kSmallStep * (1.0 + std::abs(speed_m_s))), 0.0);
  for (std::size_t i = 0; i < law.states(); ++i) {
    ContactState moved = state;
    const double dz = kSmallStep * (kSmallDepth_m + std::abs(moved.value[i]));
    moved.value[i] += dz;
    law.force(penetration_m, speed_m_s, moved);
    slopes.relaxation_1_s = std::max(slopes.relaxation_1_s, (here.rate[i] - moved.rate[i]) / dz);
  }
  return slopes;
}

ContactSlopes with_wall(ContactSlopes slopes, const WallMotion& wall) {
  if (wall.kind != WallMotionKind::free) return slopes;
  slopes.mass_kg = 1.0 / (1.0 / slopes.mass_kg + 1.0 / wall.mass_kg);
  const double part = slopes.mass_kg / wall.mass_kg;
  slopes.stiffness_N_m += part * wall.stiffness_N_m;
  slopes.damping_Ns_m += part * wall.damping_Ns_m;
  return slopes;
}

bool is_stable(Integrator integrator, double timestep_s, const ContactSlopes& slopes) {
  if (timestep_s * slopes.relaxation_1_s >= kFirstOrderLimit) return false;
  const double w = timestep_s * timestep_s * slopes.stiffness_N_m / slopes.mass_kg;
  const double d = timestep_s * slopes.damping_Ns_m / slopes.mass_kg;
  const bool is_slow = w + 2.0 * d < kLimit;
  if (integrator != Integrator::rk4 || is_slow) return is_slow;
  const double discriminant = 0.25 * d * d - w;
  const double root = std::sqrt(std::abs(discriminant));
  if (discriminant < 0.0) return growth_squared(-0.5 * d, root) <= 1.0;
  return growth_squared(-0.5 * d - root, 0.0) <= 1.0;
}

double longest_stable_timestep_s(Integrator integrator, const ContactSlopes& slopes) {
  const double w = slopes.stiffness_N_m / slopes.mass_kg;
  const double d = slopes.damping_Ns_m / slopes.mass_kg;
  const double relaxed_s = kFirstOrderLimit / slopes.relaxation_1_s;
  if (w + d == 0.0) return relaxed_s;
  double stable_s = std::min(kLimit / (d + std::sqrt(d * d + kLimit * w)), relaxed_s);
  if (integrator != Integrator::rk4) return stable_s;
  double unstable_s = kLimit * stable_s;  // RK4's region reaches at most 3.4 times as far
  for (int i = 0; i < 60; ++i) {
    const double middle_s = 0.5 * (stable_s + unstable_s);
    (is_stable(integrator, middle_s, slopes) ? stable_s : unstable_s) = middle_s;
  }
  return stable_s;
}

double dividing_timestep_s(Integrator integrator, double timestep_s, const ContactSlopes& slopes) {
  return timestep_s /
         (std::floor(timestep_s / longest_stable_timestep_s(integrator, slopes)) + 1.0);
}

std::string limit_in_words(Integrator integrator, double timestep_s, const ContactSlopes& slopes) {
  std::ostringstream text;
  text << std::setprecision(4) << "a stiffness of " << slopes.stiffness_N_m
       << " N/m and damping of " << slopes.damping_Ns_m << " N s/m with a mass of "
       << slopes.mass_kg << " kg are beyond the stability limit of the contact for a timestep of "
       << timestep_s << " s; the longest stable physics.timestep_s that divides it is "
       << std::setprecision(std::numeric_limits<double>::digits10)
       << dividing_timestep_s(integrator, timestep_s, slopes);
  return text.str();
}

}  // namespace breakwater
