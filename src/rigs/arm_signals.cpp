#include <breakwater/rigs/arm_signals.h>

#include <algorithm>
#include <memory>

namespace breakwater {

void show_geoms(Model& model, const std::string& prefix, bool visible) {
  // MJCF draws the groups 0 to 2, and not 3 to 5.
  constexpr int kShown = 2;
  constexpr int kHidden = 5;
  for (const int geom : model.geoms_named(prefix)) {
    model.get()->geom_group[geom] = visible ? kShown : kHidden;
  }
}

void log_arm(RigRun& run, AxisRig& rig, const AxisLoop& loop, const AxisPlant& plant,
             const TimeWindow& holds) {
  struct Arm {
    Eigen::VectorXd q_rad;
    Eigen::VectorXd offset_rad;  // from the start
    TipPose tip = TipPose::Zero();
    TipPose tip_offset = TipPose::Zero();
    double tip_error_m = 0.0;
  };
  const auto n = plant.axes.size();
  const Eigen::VectorXd start = plant.reference_at_start();
  const auto arm = std::make_shared<Arm>(Arm{.q_rad = start, .offset_rad = 0.0 * start});
  const auto add = [&](const char* name, const char* unit, const char* text,
                       std::span<const double> values) {
    run.signals.push_back({name, unit, text, values});
  };
  const auto gather = [&](const char* name, const char* unit, const char* text,
                          const double& (AxisRig::*of_joint)(std::size_t) const) {
    run.compute(
        name, unit, text, [&rig, of_joint](double, std::size_t i) { return (rig.*of_joint)(i); },
        n);
  };
  run.samples_end = false;
  const std::vector<Signal> tip = rig.tip_signals();
  run.fine = {{"qpos", "rad", "the engine's generalised positions", rig.positions()},
              tip[0],
              tip[1],
              tip[2]};
  run.signals = {run.fine[0]};
  add("q_true_rad", "rad", "true joint angles", view(arm->q_rad));
  gather("dq_true_rad_s", "rad/s", "true joint velocities", &AxisRig::velocity);
  // It computes all that is known of the arm.
  run.compute(
      "x_true_m", "m", "true x of the tip",
      [&rig, arm, start, chain = plant.chain, pose = plant.chain->tip_pose(start)](double, auto) {
        for (Eigen::Index i = 0; i < start.size(); ++i) {
          arm->q_rad(i) = rig.position(static_cast<std::size_t>(i));
        }
        arm->offset_rad = arm->q_rad - start;
        arm->tip = chain->tip_pose(arm->q_rad);
        arm->tip_offset = arm->tip - pose;
        arm->tip_error_m = arm->tip_offset.head<2>().norm();
        return arm->tip[0];
      });
  add("y_true_m", "m", "true y of the tip", view(arm->tip[1]));
  add("phi_true_rad", "rad", "true angle of the tip", view(arm->tip[2]));
  run.signals.push_back(run.fine[1]);
  add("q_measured_rad", "rad", "sampled joint angles", view(rig.simulation().sample().y).first(n));
  run.signals.insert(run.signals.end(), {tip[3], tip[4]});
  gather("torque_command_Nm", "N m", "commanded joint torques", &AxisRig::command);
  gather("torque_applied_Nm", "N m", "joint torques after saturation", &AxisRig::actuation);
  add("saturated", "1", "1 where any torque is at its limit", view(rig.saturated()));
  if (const WallContact* wall = rig.wall()) {
    add("wall_m", "m", "how far the wall has moved", view(wall->wall_m()));
  }
  if (std::ranges::any_of(plant.axes, [](const auto& one) { return one.drive.electric.is_on(); })) {
    gather("current_A", "A", "currents of the motors", &AxisRig::current_A);
    gather("motor_Nm", "N m", "true torques of the motors", &AxisRig::motor_force);
  }
  if (plant.knows_disturbances) {
    gather("friction_Nm", "N m", "dry friction of the joints", &AxisRig::friction);
  }
  if (std::ranges::any_of(plant.axes,
                          [](const auto& one) { return one.transmission.is_elastic(); })) {
    gather("motor_q_true_rad", "rad",
           "true angles of the motors over the ratios of their transmissions",
           &AxisRig::motor_position);
    gather("transmission_Nm", "N m", "torques of the transmissions on the joints",
           &AxisRig::transmitted);
  }
  for (const Signal& signal : loop.controller->signals()) run.signals.push_back(signal);

  run.for_metrics = {{"x_offset_m", "m", "", view(arm->tip_offset[0])},
                     {"y_offset_m", "m", "", view(arm->tip_offset[1])},
                     {"phi_offset_rad", "rad", "", view(arm->tip_offset[2])},
                     {"joint_offset_rad", "rad", "", view(arm->offset_rad)},
                     {"tip_error_m", "m", "", view(arm->tip_error_m)}};
  run.judged.emplace().push_back({HeldReference(holds, "the tip", "m"),
                                  [arm, from_s = holds.from_s](HeldReference& held, double time_s) {
                                    if (time_s <= from_s) held.ask(arm->tip_error_m);
                                    held.add(time_s, arm->tip_error_m);
                                  }});
}

}  // namespace breakwater
