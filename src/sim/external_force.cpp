#include <breakwater/sim/external_force.h>

#include <stdexcept>

namespace breakwater {

JointForce::JointForce(const Model& model, const std::string& joint)
    : joint_(model.axis(joint)),
      dof_(model->jnt_dofadr[joint_]),
      body_(model->jnt_bodyid[joint_]),
      is_from_world_(model->body_parentid[body_] == 0 && model->body_jntnum[body_] == 1),
      part_(model->jnt_type[joint_] == mjJNT_HINGE ? 3 : 0) {}

void JointForce::apply(double, const mjModel&, mjData& data) {
  if (!is_from_world_) {
    data.qfrc_applied[dof_] += force_;
    return;
  }
  // The engine adds both forms at different places of a sum, with different rounding.
  const mjtNum* axis = data.xaxis + static_cast<std::ptrdiff_t>(3) * joint_;
  mjtNum* wrench = data.xfrc_applied + static_cast<std::ptrdiff_t>(6) * body_ + part_;
  for (int i = 0; i < 3; ++i) wrench[i] += force_ * axis[i];
}

BodyForce::BodyForce(const Model& model, const std::string& body, const Eigen::Vector3d& along)
    : body_(model.id(mjOBJ_BODY, body)), along_(along.normalized()) {
  if (!(along.norm() > 0.0)) throw std::invalid_argument("a force needs a direction");
}

void BodyForce::apply(double, const mjModel&, mjData& data) {
  mjtNum* wrench = data.xfrc_applied + static_cast<std::ptrdiff_t>(6) * body_;
  for (int i = 0; i < 3; ++i) wrench[i] += force_N_ * along_(i);
}

}  // namespace breakwater
