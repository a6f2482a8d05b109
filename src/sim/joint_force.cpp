#include <breakwater/sim/joint_force.h>

namespace breakwater {

JointForce::JointForce(const Model& model, const std::string& joint)
    : joint_(model.id(mjOBJ_JOINT, joint)),
      body_(model->jnt_bodyid[joint_]),
      part_(model->jnt_type[joint_] == mjJNT_HINGE ? 3 : 0) {}

void JointForce::apply(double, const mjModel&, mjData& data) const {
  const mjtNum* axis = data.xaxis + static_cast<std::ptrdiff_t>(3) * joint_;
  mjtNum* wrench = data.xfrc_applied + static_cast<std::ptrdiff_t>(6) * body_ + part_;
  for (int i = 0; i < 3; ++i) wrench[i] += force_ * axis[i];
}

}  // namespace breakwater
