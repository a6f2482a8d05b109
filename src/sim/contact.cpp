#include <breakwater/sim/contact.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <breakwater/math/functions.h>
#include <breakwater/sim/named_elements.h>

namespace breakwater {
namespace {

constexpr double kSoftImpedance = 0.001;  // d, ten times the engine's smallest

int world_plane(const Model& model, const std::string& wall) {
  const int plane = geom_id(model, wall);
  if (model->geom_type[plane] != mjGEOM_PLANE || model->geom_bodyid[plane] != 0) {
    throw std::invalid_argument(model.file() + ": geom \"" + wall +
                                "\" must be a plane of the world body");
  }
  return plane;
}

std::vector<int> parts_of(const Model& model, const std::string& wall) {
  std::vector<int> parts = {geom_id(model, wall)};
  for (const int geom : model.geoms_named(wall + "_")) {
    if (model->geom_bodyid[geom] == 0) parts.push_back(geom);
  }
  return parts;
}

}  // namespace

void author_contact(Model& model, int geom1, int geom2, const ContactLaw& law) {
  const bool law_fits = std::isfinite(law.stiffness_N_m) && law.stiffness_N_m > 0.0 &&
                        std::isfinite(law.damping_Ns_m) && law.damping_Ns_m >= 0.0;
  if (!law_fits) {
    throw std::invalid_argument("contact: needs a stiffness > 0 and a damping >= 0");
  }
  mjModel& m = *model.get();
  for (int pair = 0; pair < m.npair; ++pair) {
    for (const int geom : {m.pair_geom1[pair], m.pair_geom2[pair]}) {
      if (geom == geom1 || geom == geom2) {
        throw std::invalid_argument(model.file() + ": a <pair> of a geom whose contact is given " +
                                    "by stiffness and damping would override it");
      }
    }
  }
  if (m.geom_priority[geom1] != m.geom_priority[geom2]) {
    throw std::invalid_argument(model.file() + ": a contact given by stiffness and damping needs " +
                                "geoms of the same priority");
  }
  double invweight = 0.0;
  for (const int geom : {geom1, geom2}) {
    if (m.geom_condim[geom] != 1) {
      throw std::invalid_argument(model.file() + ": a contact given by stiffness and damping " +
                                  "needs geoms with condim=\"1\"");
    }
    if (m.geom_margin[geom] != 0.0 || m.geom_gap[geom] != 0.0) {
      throw std::invalid_argument(model.file() + ": a contact given by stiffness and damping " +
                                  "needs geoms without margin and gap");
    }
    invweight += m.body_invweight0[2 * m.geom_bodyid[geom]];
  }
  if (!(invweight > 0.0)) {
    throw std::invalid_argument(model.file() + ": contact between two bodies that cannot move");
  }
  for (const int geom : {geom1, geom2}) {
    mjtNum* solref = m.geom_solref + static_cast<ptrdiff_t>(mjNREF) * geom;
    mjtNum* solimp = m.geom_solimp + static_cast<ptrdiff_t>(mjNIMP) * geom;
    solref[0] = -law.stiffness_N_m * invweight * (1.0 - kSoftImpedance);
    solref[1] = -law.damping_Ns_m * invweight * (1.0 - kSoftImpedance);
    solimp[0] = solimp[1] = kSoftImpedance;
  }
}

void place_wall(Model& model, const std::string& wall, double x_m) {
  const int plane = world_plane(model, wall);
  mjModel& m = *model.get();
  const double moved_m = x_m - m.geom_pos[3 * plane];
  for (const int part : parts_of(model, wall)) m.geom_pos[3 * part] += moved_m;
  m.geom_pos[3 * plane] = x_m;
}

void tilt_wall(Model& model, const std::string& wall, double angle_rad) {
  const int plane = world_plane(model, wall);
  if (angle_rad == 0.0) return;
  mjModel& m = *model.get();
  const math::SineCosine turn = math::sincos(angle_rad);
  const math::SineCosine half = math::sincos(0.5 * angle_rad);
  const mjtNum rotation[4] = {half.cosine, 0.0, 0.0, half.sine};
  const mjtNum pivot_x = m.geom_pos[3 * plane];
  const mjtNum pivot_y = m.geom_pos[3 * plane + 1];
  for (const int part : parts_of(model, wall)) {
    mjtNum* position = m.geom_pos + static_cast<ptrdiff_t>(3) * part;
    const mjtNum x = position[0] - pivot_x;
    const mjtNum y = position[1] - pivot_y;
    position[0] = pivot_x + turn.cosine * x - turn.sine * y;
    position[1] = pivot_y + turn.sine * x + turn.cosine * y;
    mjtNum* own = m.geom_quat + static_cast<ptrdiff_t>(4) * part;
    mjtNum turned[4];
    mju_mulQuat(turned, rotation, own);
    std::copy_n(turned, 4, own);
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

}  // namespace breakwater
