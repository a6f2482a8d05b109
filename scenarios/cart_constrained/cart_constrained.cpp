#include "cart_constrained/cart_constrained.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <breakwater/math/float_environment.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/rigs/predictive_settings.h>

namespace breakwater {

std::vector<MetricDefinition> CartConstrained::metric_definitions() const {
  return with_qp_metrics(
      {{"final_position_m", "m", "position at the end of the run"},
       {"final_speed_m_s", "m/s", "magnitude of the velocity at the end of the run"},
       {"max_speed_m_s", "m/s", "largest magnitude of the velocity"},
       {"max_estimated_speed_m_s", "m/s", "largest magnitude of the estimated velocity"},
       {"rms_velocity_estimate_error_m_s", "m/s",
        "root mean square of estimated minus true velocity"},
       {"velocity_estimate_travel_m_s", "m/s",
        "sum of the magnitudes of all changes of the estimated velocity from sample to sample"},
       {"max_input_N", "N", "largest magnitude of the commanded force"},
       {"input_violation_time_s", "s",
        "time for which the commanded force is beyond its limits by more than "
        "metrics.violation_slack"},
       {"speed_violation_time_s", "s",
        "time for which the speed is beyond its limit by more than metrics.violation_slack"},
       {"settling_time_s", "s",
        "time until the position stays within metrics.settled_within_m of 0. It counts from the "
        "start of the run; in conditions B and C, from the start of the force"}});
}

Fields CartConstrained::fields() {
  Fields fields;
  fields.choice("condition", condition_,
                {{"A", CartCondition::A},
                 {"B", CartCondition::B},
                 {"C", CartCondition::C},
                 {"D", CartCondition::D},
                 {"E", CartCondition::E}},
                "A: nominal. B, C: a force of 1 N or 2 N. D, E: half or one and a half times the "
                "nominal mass");
  plant_.bind(fields);
  fields.number("start.position_m", start_position_m_, any(),
                "position of the cart at the start [m]");
  fields.number("start.velocity_m_s", start_velocity_m_s_, any(),
                "velocity of the cart at the start [m/s]");
  parts_.bind(fields);
  fields.number("observer.start_position_m", estimated_start_position_m_, any(),
                "position with which the estimator starts [m]");
  fields.number("observer.start_velocity_m_s", estimated_start_velocity_m_s_, any(),
                "velocity with which the estimator starts [m/s]");
  fields.number("constraint.velocity_m_s", velocity_m_s_, positive(), "bound on |v| [m/s]");
  fields.number("constraint.input_lower_N", input_lower_N_, any(), "lower bound on the input [N]");
  fields.number("constraint.input_upper_N", input_upper_N_, any(), "upper bound on the input [N]");
  fields.number("disturbance.start_s", disturbance_start_s_, not_negative(),
                "in conditions B and C, the time at which the force begins [s]");
  fields.only_for({"disturbance.start_s"}, "condition", {"B", "C"});
  fields.number("metrics.violation_slack", violation_slack_, not_negative(),
                "excess over a limit above which the limit counts as violated [N, m/s]");
  fields.number("metrics.settled_within_m", settled_within_m_, positive(),
                "distance from 0 within which the position counts as settled [m]");
  return fields;
}

AxisPlant CartConstrained::plant() const {
  AxisPlant plant = plant_;
  plant.axis().start_position = start_position_m_;
  plant.axis().start_velocity = start_velocity_m_s_;
  plant.axis().force = disturbance();
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

AxisTask CartConstrained::task() const {
  return {.axis = plant_.nominal(),
          .start_state = {estimated_start_position_m_, estimated_start_velocity_m_s_},
          .senses_true_state = true};
}

void CartConstrained::check(const Config& config) {
  check_plant(plant_, config);
  parts_.check(config, task());
}

Recording CartConstrained::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const AxisLoop loop = parts_.make(task());
  AxisRig rig(plant(), *loop.controller);
  rig.know_loop(parts_, task());
  const Simulation& sim = rig.simulation();

  const bool is_pushed = condition_ == CartCondition::B || condition_ == CartCondition::C;
  const double period_s = plant_.physics.control_period_s;
  const double from_rest = is_pushed ? disturbance_start_s_ : 0.0;
  WindowStatistics speed(TimeWindow{}), estimated_speed(TimeWindow{}), input(TimeWindow{});
  WindowStatistics speed_error(TimeWindow{});
  double last_v_hat = 0.0;
  double v_hat_travel = 0.0;
  SettlingTime settling(TimeWindow{from_rest}, settled_within_m_);
  double input_violation_s = 0.0;
  double speed_violation_s = 0.0;

  const auto sample = [&](double t) {
    const double u = sim.command()(0);
    const double v = sim.qvel()[0];
    speed.add(t, v);
    if (loop.estimates()) {
      const double v_hat = loop.estimator->state()(1);
      estimated_speed.add(t, v_hat);
      speed_error.add(t, v_hat - v);
      if (sim.steps() > 1) v_hat_travel += std::abs(v_hat - last_v_hat);
      last_v_hat = v_hat;
    }
    input.add(t, u);
    settling.add(t, sim.qpos()[0]);
    if (u > input_upper_N_ + violation_slack_ || u < input_lower_N_ - violation_slack_) {
      input_violation_s += period_s;
    }
    if (std::abs(v) > velocity_m_s_ + violation_slack_) speed_violation_s += period_s;
  };
  const auto measured = [&] {
    std::vector<Metric> metrics;
    add(metrics, "final_position_m", "m", sim.qpos()[0]);
    add(metrics, "final_speed_m_s", "m/s", std::abs(sim.qvel()[0]));
    add(metrics, "max_speed_m_s", "m/s", speed.peak());
    add(metrics, "max_estimated_speed_m_s", "m/s", estimated_speed.peak());
    add(metrics, "rms_velocity_estimate_error_m_s", "m/s", speed_error.rms());
    if (loop.estimates()) add(metrics, "velocity_estimate_travel_m_s", "m/s", v_hat_travel);
    add(metrics, "max_input_N", "N", input.peak());
    add(metrics, "input_violation_time_s", "s", input_violation_s);
    add(metrics, "speed_violation_time_s", "s", speed_violation_s);
    add(metrics, "settling_time_s", "s", settling.value());
    return metrics;
  };
  Recording recording = rig.run(control, rig.signals(), sample, measured);
  if (!recording.failure) add_qp_metrics(*loop.controller, recording);
  return recording;
}

}  // namespace breakwater
