#include <breakwater/sim/contact.h>

#include <cmath>
#include <stdexcept>

#include <breakwater/sim/named_elements.h>

namespace breakwater {
namespace {

constexpr double kSoftImpedance = 0.001;  // d, ten times the engine's smallest

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
  const int plane = geom_id(model, wall);
  mjModel& m = *model.get();
  if (m.geom_type[plane] != mjGEOM_PLANE || m.geom_bodyid[plane] != 0) {
    throw std::invalid_argument(model.file() + ": geom \"" + wall +
                                "\" must be a plane of the world body");
  }
  const double moved_m = x_m - m.geom_pos[3 * plane];
  for (const int part : model.geoms_named(wall)) m.geom_pos[3 * part] += moved_m;
  m.geom_pos[3 * plane] = x_m;
}

}  // namespace breakwater
