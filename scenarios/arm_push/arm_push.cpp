#include "arm_push/arm_push.h"

#include <algorithm>
#include <cmath>

#include <breakwater/experiment/run_loop.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/sim/hand_on_link.h>
#include <breakwater/sim/named_elements.h>
#include "arm_push/push_metrics.h"

namespace breakwater {
namespace {

ArmRole push_role() {
  ArmRole role;
  role.starts_at_reference = true;
  return role;
}

}  // namespace

std::vector<MetricDefinition> ArmPush::metric_definitions() const {
  return PushMetrics::definitions();
}

Fields ArmPush::fields() {
  Fields fields;
  arm_.bind(fields);
  // This scenario never controls a force.
  fields.only_for({"controller.ik_weights", "controller.ik_damping", "controller.ik_form"},
                  "controller.positioning", {"workspace"});
  fields.only_where({"controller.k_force", "controller.t_approach_s", "controller.t_contact_s",
                     "controller.design_stiffness_N_m", "controller.peak_margin_N"},
                    "force is controlled (never in this scenario)", [] { return false; });
  fields.count("push.link", link_, between(1, 100), "number of the link whose end the hand pushes");
  fields.number("push.angle_rad", hand_.angle_rad, any(),
                "angle by which the hand turns the link [rad]");
  fields.number("push.start_s", hand_.start_s, not_negative(), "time at which the hand grips [s]");
  fields.number("push.rise_s", hand_.rise_s, positive(),
                "time that the hand takes to turn the link [s]");
  fields.number("push.hold_s", hand_.hold_s, not_negative(),
                "time for which the hand then holds the link [s]");
  fields.number("push.stiffness_Nm_rad", hand_.stiffness_Nm_rad, positive(),
                "stiffness of the hand about the link's joint [N m/rad]");
  fields.number("push.damping_Nms_rad", hand_.damping_Nms_rad, not_negative(),
                "damping of the hand about the link's joint [N m s/rad]");
  fields.number("metrics.settled_within_m", settled_within_m_, positive(),
                "distance from the start pose within which the tip counts as settled [m]");
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
  const math::FloatEnvironment floats;
  ArmRig rig(arm_, push_role());
  Simulation& sim = rig.simulation();
  const HandOnLink hand(hand_, sim.model(), rig.chain(), arm_.start_angles_rad, link_);
  sim.add(hand);
  if (has_geom(sim.model(), "wall")) sim.set_collidable(geom_id(sim.model(), "wall"), false);

  double turned_rad = 0.0;
  double moment_Nm = 0.0;
  std::vector<Signal> signals = rig.signals();
  signals.push_back(
      {"push_turned_rad", "rad", "angle by which the pushed link is turned", view(turned_rad)});
  signals.push_back(
      {"push_moment_Nm", "N m", "moment of the hand about the joint", view(moment_Nm)});
  PushMetrics metrics({.grip_s = hand_.start_s,
                       .release_s = hand_.release_s(),
                       .start_angles_rad = arm_.start_angles_rad,
                       .start_pose = start_pose(arm_),
                       .settled_within_m = settled_within_m_,
                       .period_s = arm_.physics.control_period_s});

  const TipPose pose = start_pose(arm_);
  HeldReference held({hand_.release_s(), arm_.run.duration_s}, "the tip", "m");
  const auto sample = [&](double time_s) {
    rig.observe();
    const double away_m = (pose - rig.tip()).head<2>().norm();
    if (time_s < hand_.release_s()) held.ask(away_m);
    held.add(time_s, away_m);
    turned_rad = hand.turned_rad(sim.qpos());
    moment_Nm = hand.moment_Nm(time_s, sim.qpos(), sim.qvel());
    metrics.after_sample(time_s, rig.q(), rig.dq(), rig.tip(), turned_rad, sim.saturated());
  };
  Recording recording = record_run(
      sim, arm_.physics, arm_.physics.step_at(arm_.run.duration_s), std::move(signals), control,
      [&](std::int64_t) { sim.step(); }, sample, [&] { return metrics.metrics(); });
  if (!recording.failure) held.warn(recording.warnings);
  return recording;
}

}  // namespace breakwater
