#include "cart_constrained/cart_constrained.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <breakwater/control/lqr_control.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/scenario/run_loop.h>

namespace breakwater {

Fields CartConstrained::fields() {
  Fields fields;
  fields.choice("condition", condition_,
                {{"A", CartCondition::A},
                 {"B", CartCondition::B},
                 {"C", CartCondition::C},
                 {"D", CartCondition::D},
                 {"E", CartCondition::E}},
                "A nothing, B 1 N, C 2 N, D half the mass, E one and a half times the mass");
  axis_.bind(fields);
  fields.number("start.position_m", start_position_m_, any(), "of the cart [m]");
  fields.number("start.velocity_m_s", start_velocity_m_s_, any(), "of the cart [m/s]");
  estimator_.bind(fields);
  fields.number("observer.start_position_m", estimated_start_position_m_, any(),
                "what the estimator starts with [m]");
  fields.number("observer.start_velocity_m_s", estimated_start_velocity_m_s_, any(),
                "what the estimator starts with [m/s]");
  fields.choice("controller.name", controller_,
                {{"lqr", CartControllerKind::lqr},
                 {"lqr_observer", CartControllerKind::lqr_observer},
                 {"mpc", CartControllerKind::mpc}},
                "lqr (on the true state), lqr_observer (on estimates, cancelling d) or mpc");
  mpc_.bind(fields);
  for (const std::string& key : CartMpcSettings::predictive_keys()) {
    // What the metrics take for the limits, whatever the controller.
    const bool is_limit = key == "constraint.velocity_m_s" || key == "constraint.input_lower_N" ||
                          key == "constraint.input_upper_N";
    if (!is_limit) fields.only_for({key}, "controller.name", {"mpc"});
  }
  fields.number("disturbance.start_s", disturbance_start_s_, not_negative(),
                "B and C: when the force begins [s]");
  fields.only_for({"disturbance.start_s"}, "condition", {"B", "C"});
  fields.number("metrics.violation_slack", violation_slack_, not_negative(),
                "a limit counts as violated from this far beyond it [N, m/s]");
  fields.number("metrics.settled_within_m", settled_within_m_, positive(),
                "settled: the position stays this close to 0 [m]");
  return fields;
}

AxisSettings CartConstrained::plant() const {
  AxisSettings plant = axis_;
  plant.start_position = start_position_m_;
  plant.start_velocity = start_velocity_m_s_;
  plant.senses_true_state = true;
  if (condition_ == CartCondition::D) plant.inertia_ratio *= 0.5;
  if (condition_ == CartCondition::E) plant.inertia_ratio *= 1.5;
  return plant;
}

Disturbance CartConstrained::disturbance() const {
  Disturbance force{DisturbanceKind::step, 0.0, 0.0, disturbance_start_s_};
  if (condition_ == CartCondition::B) force.amplitude = 1.0;
  if (condition_ == CartCondition::C) force.amplitude = 2.0;
  return force;
}

Eigen::VectorXd CartConstrained::estimator_start() const {
  return Eigen::Vector2d(estimated_start_position_m_, estimated_start_velocity_m_s_);
}

void CartConstrained::check(const Config& config) {
  check_axis(axis_, config);
  mpc_.check(axis_, config);
  config.blame("observer.name", [&] { make_estimator(estimator_, axis_); });
  config.blame("controller.r", [&] { mpc_.regulator(axis_.nominal_plant()); });
  if (controller_ != CartControllerKind::mpc && mpc_.period_s != axis_.physics.control_period_s) {
    config.fail("controller.period_s", "must be control.period_s for a regulator");
  }
}

Recording CartConstrained::run(const RunControl& control) const {
  auto estimator = make_estimator(estimator_, axis_);
  const DisturbanceEstimator& estimates = *estimator;
  std::unique_ptr<Controller> controller;
  const Lmpc* lmpc = nullptr;
  if (controller_ == CartControllerKind::mpc) {
    PredictiveControlDesign design = mpc_.design(axis_);
    design.start_state = estimator_start();
    auto predictive = std::make_unique<PredictiveControl>(std::move(estimator), design);
    lmpc = &predictive->lmpc();
    controller = std::move(predictive);
  } else {
    controller = std::make_unique<LqrControl>(
        std::move(estimator), mpc_.regulator(axis_.nominal_plant()).K, estimator_start(),
        controller_ == CartControllerKind::lqr, axis_.force_limit());
  }
  AxisRig rig(plant(), {.force = disturbance()}, *controller);
  Simulation& sim = rig.simulation();
  const std::int64_t steps = axis_.physics.step_at(axis_.run.duration_s);
  Track log("control", rig.signals(),
            static_cast<std::size_t>(steps / axis_.physics.steps_per_sample() + 1));

  const bool is_pushed = condition_ == CartCondition::B || condition_ == CartCondition::C;
  const double period_s = axis_.physics.control_period_s;
  const double from_rest = is_pushed ? disturbance_start_s_ : 0.0;
  WindowStatistics speed(TimeWindow{}), estimated_speed(TimeWindow{}), input(TimeWindow{});
  WindowStatistics speed_error(TimeWindow{});
  double last_v_hat = 0.0;
  double v_hat_travel = 0.0;
  SettlingTime settling(TimeWindow{from_rest}, settled_within_m_);
  double input_violation_s = 0.0;
  double speed_violation_s = 0.0;

  Recording recording;
  // One step more than the duration has, so that the sample at its end is there.
  recording.failure = run_loop(steps + 1, control, [&](std::int64_t) {
    rig.step();
    if (!sim.sampled()) return;
    const double t = sim.time_s();
    const double u = sim.command()(0);
    const double v = sim.qvel()[0];
    speed.add(t, v);
    const double v_hat = estimates.state()(1);
    estimated_speed.add(t, v_hat);
    speed_error.add(t, v_hat - v);
    if (log.rows() > 0) v_hat_travel += std::abs(v_hat - last_v_hat);
    last_v_hat = v_hat;
    input.add(t, u);
    settling.add(t, sim.qpos()[0]);
    if (u > mpc_.input_upper_N + violation_slack_ || u < mpc_.input_lower_N - violation_slack_) {
      input_violation_s += period_s;
    }
    if (std::abs(v) > mpc_.velocity_m_s + violation_slack_) speed_violation_s += period_s;
    log.append(t);
  });

  conclude(recording, sim);
  if (!recording.failure) {
    std::vector<Metric>& metrics = recording.metrics;
    add(metrics, "final_position_m", "m", sim.qpos()[0]);
    add(metrics, "final_speed_m_s", "m/s", std::abs(sim.qvel()[0]));
    add(metrics, "max_speed_m_s", "m/s", speed.peak());
    add(metrics, "max_estimated_speed_m_s", "m/s", estimated_speed.peak());
    add(metrics, "rms_velocity_estimate_error_m_s", "m/s", speed_error.rms());
    add(metrics, "velocity_estimate_travel_m_s", "m/s", v_hat_travel);
    add(metrics, "max_input_N", "N", input.peak());
    add(metrics, "input_violation_time_s", "s", input_violation_s);
    add(metrics, "speed_violation_time_s", "s", speed_violation_s);
    add(metrics, "settling_time_s", "s", settling.value());
    if (lmpc != nullptr) add_qp_metrics(lmpc->statistics(), recording);
  }
  recording.tracks.push_back(std::move(log));
  return recording;
}

}  // namespace breakwater
