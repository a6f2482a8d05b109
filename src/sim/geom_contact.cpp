#include <breakwater/sim/geom_contact.h>

namespace breakwater {

GeomContact::GeomContact(const Model& model, const std::string& geom_1, const std::string& geom_2)
    : geom_1_(model.id(mjOBJ_GEOM, geom_1)), geom_2_(model.id(mjOBJ_GEOM, geom_2)) {}

double GeomContact::force_N(const Model& model, const mjData& data) const {
  double sum = 0.0;
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    const bool is_theirs = (contact.geom1 == geom_1_ && contact.geom2 == geom_2_) ||
                           (contact.geom1 == geom_2_ && contact.geom2 == geom_1_);
    if (!is_theirs) continue;
    mjtNum force[6];
    mj_contactForce(model.get(), &data, i, force);
    sum += force[0];
  }
  return sum;
}

}  // namespace breakwater
