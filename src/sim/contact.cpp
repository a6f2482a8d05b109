#include <breakwater/sim/contact.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <breakwater/math/functions.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

constexpr double kHorizontal = 1e-3;      // sine of a plane's normal with the vertical
constexpr double kSoftImpedance = 0.001;  // d, ten times the engine's smallest

// The wall and its parts, to be moved. The engine computes no frame of a geom whose frame was its
// body's in the file, unless it is told that this is over.
std::vector<int> movable_parts(Model& model, const std::string& wall) {
  std::vector<int> parts = {geom_id(model, wall)};
  for (const int geom : model.geoms_named(wall + "_")) {
    if (model->geom_bodyid[geom] == 0) parts.push_back(geom);
  }
  for (const int part : parts) model.get()->geom_sameframe[part] = 0;
  return parts;
}

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

int world_plane(const Model& model, const std::string& wall) {
  const int plane = geom_id(model, wall);
  if (model->geom_type[plane] != mjGEOM_PLANE || model->geom_bodyid[plane] != 0) {
    throw std::invalid_argument(model.file() + ": geom \"" + wall +
                                "\" must be a plane of the world body");
  }
  return plane;
}

void author_contact(Model& model, int geom1, int geom2, const KelvinVoigt& law) {
  mjModel& m = *model.get();
  for (int pair = 0; pair < m.npair; ++pair) {
    for (const int geom : {m.pair_geom1[pair], m.pair_geom2[pair]}) {
      if (geom == geom1 || geom == geom2) {
        throw std::invalid_argument(model.file() + ": a <pair> of a geom whose contact is given " +
                                    "by stiffness and damping would override it");
      }
    }
  }
  const auto need_geoms = [&](bool are_so, const char* words) {
    if (are_so) return;
    throw std::invalid_argument(model.file() +
                                ": a contact given by stiffness and damping needs geoms " + words);
  };
  need_geoms(m.geom_priority[geom1] == m.geom_priority[geom2], "of the same priority");
  double invweight = 0.0;
  for (const int geom : {geom1, geom2}) {
    need_geoms(m.geom_condim[geom] == 1, "with condim=\"1\"");
    need_geoms(m.geom_margin[geom] == 0.0 && m.geom_gap[geom] == 0.0, "without margin and gap");
    invweight += m.body_invweight0[2 * m.geom_bodyid[geom]];
  }
  if (!(invweight > 0.0)) {
    throw std::invalid_argument(model.file() + ": contact between two bodies that cannot move");
  }
  for (const int geom : {geom1, geom2}) {
    mjtNum* solref = m.geom_solref + static_cast<ptrdiff_t>(mjNREF) * geom;
    mjtNum* solimp = m.geom_solimp + static_cast<ptrdiff_t>(mjNIMP) * geom;
    solref[0] = -law.stiffness_N_m() * invweight * (1.0 - kSoftImpedance);
    solref[1] = -law.damping_Ns_m() * invweight * (1.0 - kSoftImpedance);
    solimp[0] = solimp[1] = kSoftImpedance;
  }
}

void place_wall(Model& model, const std::string& wall, double x_m) {
  const int plane = world_plane(model, wall);
  mjModel& m = *model.get();
  const double moved_m = x_m - m.geom_pos[3 * plane];
  for (const int part : movable_parts(model, wall)) m.geom_pos[3 * part] += moved_m;
  m.geom_pos[3 * plane] = x_m;
}

void tilt_wall(Model& model, const std::string& wall, double angle_rad) {
  const int plane = world_plane(model, wall);
  if (angle_rad == 0.0) return;
  mjModel& m = *model.get();
  const auto geom_frame = [&m](int geom) { return m.geom_quat + static_cast<ptrdiff_t>(4) * geom; };
  mjtNum frame[9], axis[3], pivot[3], rotation[4];
  mju_quat2Mat(frame, geom_frame(plane));
  const mjtNum normal[3] = {frame[2], frame[5], frame[8]};
  for (int i = 0; i < 3; ++i) axis[i] = (i == 2 ? 1.0 : 0.0) - normal[2] * normal[i];
  if (mju_normalize3(axis) < kHorizontal) {
    for (int i = 0; i < 3; ++i) axis[i] = frame[3 * i + 1];
  }
  const math::SineCosine half = math::sincos(0.5 * angle_rad);
  rotation[0] = half.cosine;
  mju_scl3(rotation + 1, axis, half.sine);
  mju_copy3(pivot, m.geom_pos + static_cast<ptrdiff_t>(3) * plane);
  for (const int part : movable_parts(model, wall)) {
    mjtNum* position = m.geom_pos + static_cast<ptrdiff_t>(3) * part;
    mjtNum from_pivot[3], turned[4];
    mju_sub3(from_pivot, position, pivot);
    mju_rotVecQuat(position, from_pivot, rotation);
    mju_addTo3(position, pivot);
    mju_mulQuat(turned, rotation, geom_frame(part));
    std::copy_n(turned, 4, geom_frame(part));
  }
}

GeomContact::GeomContact(const Model& model, const std::string& geom_1, const std::string& geom_2)
    : geom_1_(model.id(mjOBJ_GEOM, geom_1)), geom_2_(model.id(mjOBJ_GEOM, geom_2)) {}

double GeomContact::force_N(const mjModel& model, const mjData& data) const {
  double sum = 0.0;
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    const bool is_theirs = (contact.geom1 == geom_1_ && contact.geom2 == geom_2_) ||
                           (contact.geom1 == geom_2_ && contact.geom2 == geom_1_);
    if (!is_theirs) continue;
    mjtNum force[6];
    mj_contactForce(&model, &data, i, force);
    sum += force[0];
  }
  return sum;
}

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
