#include "motor_estimation/motor_estimation.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <breakwater/math/float_environment.h>
#include <breakwater/record/window_metrics.h>

namespace breakwater {
namespace {

// The signal that the estimator publishes under this name; empty if there is none.
std::span<const double> published(const std::vector<Signal>& signals, const std::string& name) {
  for (const Signal& signal : signals) {
    if (signal.name == name) return signal.values;
  }
  return {};
}

}  // namespace

std::vector<MetricDefinition> MotorEstimation::metric_definitions() const {
  return {
      {"rmse_velocity_rad_s", "rad/s",
       "root mean square error of the estimated velocity, from metrics.from_s to metrics.to_s"},
      {"rmse_raw_velocity_rad_s", "rad/s",
       "root mean square error of the raw difference of the measured angle, in the same window"},
      {"rmse_position_rad", "rad",
       "root mean square error of the estimated angle, in the same window"},
      {"rmse_disturbance_Nm", "N m",
       "root mean square error of the estimated disturbance, in the same window"},
      {"peak_position_rad", "rad", "largest magnitude of the true angle in the whole run"},
      {"rms_position_rad", "rad", "root mean square of the true angle from disturbance.start_s"},
      {"rms_torque_Nm", "N m", "root mean square of the applied torque from disturbance.start_s"},
      {"disturbance_settling_time_s", "s",
       "for a step: time until the estimated disturbance stays within metrics.settled_within times "
       "the step"},
      {"transient_rmse_disturbance_Nm", "N m",
       "root mean square error of the estimated disturbance, from disturbance.start_s to "
       "metrics.from_s"},
      {"lambda_mean_1", "1", "mean of the forgetting factor, from metrics.from_s to metrics.to_s"},
      {"lambda_min_1", "1", "smallest forgetting factor of the whole run"},
      {"slowest_pole_continuous_rad_s", "rad/s",
       "mean of the real part of the estimator's slowest pole, converted to continuous time, from "
       "metrics.from_s to metrics.to_s"}};
}

Fields MotorEstimation::fields() {
  Fields fields;
  plant_.bind(fields);
  parts_.bind(fields);
  disturbance_.bind(fields, "Nm", "N m");
  fields.number("metrics.from_s", from_s_, not_negative(),
                "start of the window of the errors, and end of the window of the transient [s]");
  fields.number("metrics.to_s", plant_.judged_to_s, not_negative(),
                "end of the window of the errors [s]");
  fields.number(
      "metrics.settled_within", settled_within_, positive(),
      "distance from the disturbance, relative to its amplitude, within which the estimate "
      "counts as settled");
  return fields;
}

AxisPlant MotorEstimation::plant() const {
  AxisPlant plant = plant_;
  plant.axis().force = disturbance_.make(plant.run.seed, "disturbance");
  return plant;
}

void MotorEstimation::check(const Config& config) {
  check_plant(plant_, config);
  disturbance_.load(config);
  parts_.check(config, task());
  if (plant_.judged_to_s <= from_s_)
    config.fail("metrics.to_s", "must be later than metrics.from_s");
}

Recording MotorEstimation::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const AxisLoop loop = parts_.make(task());
  AxisRig rig(plant(), *loop.controller);
  rig.know_loop(parts_, task());
  const Simulation& sim = rig.simulation();
  // For comparison with tables of a differentiated encoder. The controller does not use it.
  double raw_velocity = 0.0;
  double last_angle = 0.0;
  double measurement_error = 0.0;
  std::vector<Signal> signals = rig.signals();
  signals.push_back({"velocity_raw_rad_s", "rad/s",
                     "raw difference of the measured angle over a sample; 0 at the first",
                     view(raw_velocity)});
  signals.push_back(
      {"measurement_error_rad", "rad", "sampled minus true angle", view(measurement_error)});

  const Disturbance& disturbance = disturbance_.shape;
  const double start_s = disturbance.start_s;
  const double end_s = plant_.run.duration_s;
  const TimeWindow window = TimeWindow{from_s_, plant_.judged_to_s}.within(end_s);
  const TimeWindow transient = TimeWindow{start_s, from_s_}.within(end_s);
  WindowStatistics velocity_error(window), position_error(window), disturbance_error(window);
  WindowStatistics raw_velocity_error(window), transient_error(transient);
  WindowStatistics position(TimeWindow{}), lambda(window), any_lambda(TimeWindow{});
  const TimeWindow disturbed = TimeWindow{start_s}.within(end_s);
  WindowStatistics disturbed_position(disturbed), torque(disturbed);
  WindowStatistics slowest_pole(window);
  const std::span<const double> lambda_now = published(signals, "lambda");
  const std::span<const double> poles = published(signals, "poles_continuous_re_rad_s");
  SettlingTime settling(TimeWindow{start_s, plant_.judged_to_s}.within_and_on(end_s),
                        settled_within_ * std::abs(disturbance.amplitude));

  const auto step = [&](std::int64_t k) {
    loop.controller->set_watched(control.logs || window.contains(sim.time_of(k)));
    rig.step();
  };
  const auto sample = [&](double t) {
    const double angle = sim.sample().y(0);
    raw_velocity = sim.steps() == 1 ? 0.0 : (angle - last_angle) / plant_.physics.control_period_s;
    last_angle = angle;
    measurement_error = angle - sim.qpos()[0];
    raw_velocity_error.add(t, raw_velocity - sim.qvel()[0]);
    position.add(t, sim.qpos()[0]);
    disturbed_position.add(t, sim.qpos()[0]);
    torque.add(t, sim.actuation()[0]);
    if (loop.estimates()) {
      const double d_error = loop.estimator->disturbance()(0) - rig.disturbance();
      velocity_error.add(t, loop.estimator->state()(1) - sim.qvel()[0]);
      position_error.add(t, loop.estimator->state()(0) - sim.qpos()[0]);
      disturbance_error.add(t, d_error);
      transient_error.add(t, d_error);
      settling.add(t, d_error);
    }
    if (!lambda_now.empty()) {
      lambda.add(t, lambda_now.front());
      any_lambda.add(t, lambda_now.front());
    }
    if (!poles.empty()) slowest_pole.add(t, *std::max_element(poles.begin(), poles.end()));
  };
  const auto measured = [&] {
    std::vector<Metric> metrics;
    add(metrics, "rmse_velocity_rad_s", "rad/s", velocity_error.rms());
    add(metrics, "rmse_raw_velocity_rad_s", "rad/s", raw_velocity_error.rms());
    add(metrics, "rmse_position_rad", "rad", position_error.rms());
    add(metrics, "rmse_disturbance_Nm", "N m", disturbance_error.rms());
    add(metrics, "peak_position_rad", "rad", position.peak());
    add(metrics, "rms_position_rad", "rad", disturbed_position.rms());
    add(metrics, "rms_torque_Nm", "N m", torque.rms());
    if (disturbance.kind == DisturbanceKind::step) {
      add(metrics, "disturbance_settling_time_s", "s", settling.value());
    }
    add(metrics, "transient_rmse_disturbance_Nm", "N m", transient_error.rms());
    add(metrics, "lambda_mean_1", "1", lambda.mean());
    add(metrics, "lambda_min_1", "1", any_lambda.smallest());
    add(metrics, "slowest_pole_continuous_rad_s", "rad/s", slowest_pole.mean());
    return metrics;
  };
  return rig.run(control, std::move(signals), step, sample, measured);
}

}  // namespace breakwater
