#include <breakwater/sim/hand_on_link.h>

#include <string>

namespace breakwater {

HandOnLink::HandOnLink(const Hand& hand, const Model& model, const PlanarChain& chain,
                       const Eigen::VectorXd& gripped_angles_rad, int link)
    : hand_(hand),
      joint_(model.id(mjOBJ_JOINT, chain.joint(link - 1).name)),
      body_(model->jnt_bodyid[joint_]),
      end_(model.id(mjOBJ_SITE, "link" + std::to_string(link) + "_end")) {
  for (Eigen::Index i = 0; i < link; ++i) {
    const int id = model.id(mjOBJ_JOINT, chain.joint(i).name);
    senses_.push_back(chain.joint(i).sense);
    qpos_.push_back(static_cast<std::size_t>(model->jnt_qposadr[id]));
    dofs_.push_back(static_cast<std::size_t>(model->jnt_dofadr[id]));
    gripped_angle_rad_ += senses_.back() * gripped_angles_rad(i);
  }
}

void HandOnLink::apply(double time_s, const mjModel& model, mjData& data) {
  const double moment = moment_Nm(time_s, {data.qpos, static_cast<std::size_t>(model.nq)},
                                  {data.qvel, static_cast<std::size_t>(model.nv)});
  if (moment == 0.0) return;
  const mjtNum* anchor = data.xanchor + static_cast<std::ptrdiff_t>(3) * joint_;
  const mjtNum* end = data.site_xpos + static_cast<std::ptrdiff_t>(3) * end_;
  const mjtNum* center = data.xipos + static_cast<std::ptrdiff_t>(3) * body_;
  const double arm_x = end[0] - anchor[0];
  const double arm_y = end[1] - anchor[1];
  const double per_metre = moment / (arm_x * arm_x + arm_y * arm_y);
  const double force_x = -arm_y * per_metre;
  const double force_y = arm_x * per_metre;
  mjtNum* wrench = data.xfrc_applied + static_cast<std::ptrdiff_t>(6) * body_;
  wrench[0] += force_x;
  wrench[1] += force_y;
  wrench[5] += (end[0] - center[0]) * force_y - (end[1] - center[1]) * force_x;
}

double HandOnLink::turned_rad(std::span<const double> qpos) const {
  double angle = -gripped_angle_rad_;
  for (std::size_t i = 0; i < qpos_.size(); ++i) angle += senses_[i] * qpos[qpos_[i]];
  return angle;
}

double HandOnLink::moment_Nm(double time_s, std::span<const double> qpos,
                             std::span<const double> qvel) const {
  double rate = 0.0;
  for (std::size_t i = 0; i < dofs_.size(); ++i) rate += senses_[i] * qvel[dofs_[i]];
  return hand_.moment_Nm(time_s, turned_rad(qpos), rate);
}

}  // namespace breakwater
