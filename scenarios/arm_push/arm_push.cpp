#include "arm_push/arm_push.h"

#include <algorithm>
#include <cmath>

#include <breakwater/scenario/run_loop.h>
#include "arm_push/push_metrics.h"

namespace breakwater {
namespace {

ArmRole push_role() {
  ArmRole role;
  role.starts_at_reference = true;
  return role;
}

// The hand's force on the end of a link, perpendicular to it.
class HandOnLink final : public ExternalForce {
 public:
  HandOnLink(const Hand& hand, const Model& model, const PlanarChain& chain,
             const std::vector<double>& start_angles_rad, int link)
      : hand_(hand),
        joint_(model.id(mjOBJ_JOINT, chain.joint(link - 1).name)),
        body_(model->jnt_bodyid[joint_]),
        end_(model.id(mjOBJ_SITE, "link" + std::to_string(link) + "_end")) {
    for (Eigen::Index i = 0; i < link; ++i) {
      const int id = model.id(mjOBJ_JOINT, chain.joint(i).name);
      senses_.push_back(chain.joint(i).sense);
      qpos_.push_back(model->jnt_qposadr[id]);
      dofs_.push_back(model->jnt_dofadr[id]);
      gripped_angle_rad_ += senses_.back() * start_angles_rad[static_cast<std::size_t>(i)];
    }
  }

  void apply(double time_s, const mjModel&, mjData& data) const override {
    const double moment = moment_Nm(time_s, data.qpos, data.qvel);
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

  // How far the link is turned from where it was gripped.
  double turned_rad(const mjtNum* qpos) const {
    double angle = -gripped_angle_rad_;
    for (std::size_t i = 0; i < qpos_.size(); ++i) angle += senses_[i] * qpos[qpos_[i]];
    return angle;
  }

  double moment_Nm(double time_s, const mjtNum* qpos, const mjtNum* qvel) const {
    double rate = 0.0;
    for (std::size_t i = 0; i < dofs_.size(); ++i) rate += senses_[i] * qvel[dofs_[i]];
    return hand_.moment_Nm(time_s, turned_rad(qpos), rate);
  }

 private:
  Hand hand_;
  int joint_;
  int body_;
  int end_;
  std::vector<double> senses_;
  std::vector<int> qpos_;
  std::vector<int> dofs_;
  double gripped_angle_rad_ = 0.0;
};

}  // namespace

Fields ArmPush::fields() {
  Fields fields;
  arm_.bind(fields);
  // It never controls a force.
  fields.only_for({"controller.ik_weights", "controller.ik_damping", "controller.ik_form"},
                  "controller.positioning", {"workspace"});
  fields.only_where({"controller.k_force"}, "force is controlled, as it is not in this scenario",
                    [] { return false; });
  fields.count("push.link", link_, between(1, 100), "which link's end the hand pushes");
  fields.number("push.angle_rad", hand_.angle_rad, any(),
                "how far it turns the link's absolute angle [rad]");
  fields.number("push.start_s", hand_.start_s, not_negative(), "when it grips [s]");
  fields.number("push.rise_s", hand_.rise_s, positive(), "how long it takes to turn it [s]");
  fields.number("push.hold_s", hand_.hold_s, not_negative(), "how long it holds it then [s]");
  fields.number("push.stiffness_Nm_rad", hand_.stiffness_Nm_rad, positive(),
                "of the hand, about the link's joint [N m/rad]");
  fields.number("push.damping_Nms_rad", hand_.damping_Nms_rad, not_negative(),
                "of the hand, about the link's joint [N m s/rad]");
  fields.number("metrics.settled_within_m", settled_within_m_, positive(),
                "settled: the tip stays this close to the start pose [m]");
  return fields;
}

void ArmPush::check(const Config& config) {
  check_arm(arm_, push_role(), config);
  if (link_ > static_cast<int>(arm_.start_angles_rad.size())) {
    config.fail("push.link",
                "the arm has only " + std::to_string(arm_.start_angles_rad.size()) + " links");
  }
  const ArmRig rig(arm_, push_role());
  HandOnLink(hand_, rig.simulation().model(), rig.chain(), arm_.start_angles_rad, link_);
}

void ArmPush::prepare_scene(Model& model) const {
  show_geoms(model, "wall_", false);
}

Recording ArmPush::run(const RunControl& control) const {
  ArmRig rig(arm_, push_role());
  Simulation& sim = rig.simulation();
  const HandOnLink hand(hand_, sim.model(), rig.chain(), arm_.start_angles_rad, link_);
  sim.add(hand);
  sim.set_collidable(sim.model().id(mjOBJ_GEOM, "wall"), false);

  const std::int64_t steps = arm_.physics.step_at(arm_.run.duration_s);
  double turned_rad = 0.0;
  double moment_Nm = 0.0;
  std::vector<Signal> signals = rig.signals();
  signals.push_back(
      {"push_turned_rad", "rad", "how far the pushed link is turned", view(turned_rad)});
  signals.push_back(
      {"push_moment_Nm", "N m", "the hand's moment about its joint", view(moment_Nm)});
  Track log("control", std::move(signals),
            static_cast<std::size_t>(steps / arm_.physics.steps_per_sample() + 1));
  PushMetrics metrics({.grip_s = hand_.start_s,
                       .release_s = hand_.release_s(),
                       .start_angles_rad = arm_.start_angles_rad,
                       .start_pose = start_pose(arm_),
                       .settled_within_m = settled_within_m_,
                       .period_s = arm_.physics.control_period_s});

  Recording recording;
  recording.failure = run_loop(steps, control, [&](std::int64_t) {
    sim.step();
    if (!sim.sampled()) return;
    rig.observe();
    turned_rad = hand.turned_rad(sim.qpos().data());
    moment_Nm = hand.moment_Nm(sim.time_s(), sim.qpos().data(), sim.qvel().data());
    metrics.after_sample(sim.time_s(), rig.q(), rig.dq(), rig.tip(), turned_rad, sim.saturated());
    log.append(sim.time_s());
  });

  conclude(recording, sim);
  if (!recording.failure) recording.metrics = metrics.metrics();
  recording.tracks.push_back(std::move(log));
  return recording;
}

}  // namespace breakwater
