#include <breakwater/sim/body_force.h>

#include <stdexcept>

namespace breakwater {

BodyForce::BodyForce(const Model& model, const std::string& body, const Eigen::Vector3d& along)
    : body_(model.id(mjOBJ_BODY, body)), along_(along.normalized()) {
  if (!(along.norm() > 0.0)) throw std::invalid_argument("a force needs a direction");
}

void BodyForce::apply(double, const mjModel&, mjData& data) const {
  mjtNum* wrench = data.xfrc_applied + static_cast<std::ptrdiff_t>(6) * body_;
  for (int i = 0; i < 3; ++i) wrench[i] += force_N_ * along_(i);
}

}  // namespace breakwater
