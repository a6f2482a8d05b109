#include "motor_estimation/motor_estimation.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <breakwater/control/disturbance_cancelling_pd.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/scenario/run_loop.h>

namespace breakwater {
namespace {

// What a controller publishes under a name; empty if it has none such.
std::span<const double> published(const Controller& controller, const std::string& name) {
  for (const Signal& signal : controller.signals()) {
    if (signal.name == name) return signal.values;
  }
  return {};
}

}  // namespace

Fields MotorEstimation::fields() {
  Fields fields;
  axis_.bind(fields);
  estimator_.bind(fields);
  fields.number("observer.lambda", lambda_, between(0.01, 1),
                "fakfd: the forgetting factor of all states, 1/gamma");
  fields.only_for({"observer.lambda"}, "observer.name", {"fakfd"});
  fields.number("controller.kp", k_p_, not_negative(), "K_p [N m/rad]");
  fields.number("controller.kd", k_d_, not_negative(), "K_d [N m s/rad]");
  fields.choice("disturbance.kind", disturbance_.kind,
                {{"none", DisturbanceKind::none},
                 {"step", DisturbanceKind::step},
                 {"ramp", DisturbanceKind::ramp},
                 {"sine", DisturbanceKind::sine}},
                "none, step, ramp or sine");
  fields.number("disturbance.amplitude_Nm", disturbance_.amplitude, any(),
                "of a step or sine [N m]; of a ramp [N m/s]");
  fields.number("disturbance.frequency_rad_s", disturbance_.frequency_rad_s, any(),
                "of a sine [rad/s]");
  fields.only_for({"disturbance.amplitude_Nm"}, "disturbance.kind", {"step", "ramp", "sine"});
  fields.only_for({"disturbance.frequency_rad_s"}, "disturbance.kind", {"sine"});
  fields.number("disturbance.start_s", disturbance_.start_s, not_negative(), "when it begins [s]");
  fields.number("metrics.from_s", from_s_, not_negative(),
                "the errors' window begins, and the transient's ends [s]");
  fields.number("metrics.to_s", to_s_, not_negative(), "the errors' window ends [s]");
  fields.number("metrics.settled_within", settled_within_, positive(),
                "settled: the estimate stays this close to the disturbance, over its amplitude");
  return fields;
}

void MotorEstimation::check(const Config& config) {
  check_axis(axis_, config);
  estimator_.gamma = 1.0 / lambda_;
  config.blame("observer.name", [&] { make_estimator(estimator_, axis_); });
  if (to_s_ <= from_s_) config.fail("metrics.to_s", "must be later than metrics.from_s");
}

Recording MotorEstimation::run(const RunControl& control) const {
  DisturbanceCancellingPd controller(make_estimator(estimator_, axis_),
                                     {.k_p = k_p_,
                                      .k_d = k_d_,
                                      .force_limit = axis_.force_limit(),
                                      .period_s = axis_.physics.control_period_s,
                                      .units = axis_.axis.units});
  AxisRig rig(axis_, {.force = disturbance_}, controller);
  Simulation& sim = rig.simulation();
  const std::int64_t steps = axis_.physics.step_at(axis_.run.duration_s);
  // What tables of a differentiated encoder have: not what the controller works with.
  double raw_velocity = 0.0;
  double last_angle = 0.0;
  std::vector<Signal> signals = rig.signals();
  signals.push_back({"velocity_raw_rad_s", "rad/s",
                     "raw difference of the measured angle over a sample; 0 at the first",
                     view(raw_velocity)});
  Track log("control", std::move(signals),
            static_cast<std::size_t>(steps / axis_.physics.steps_per_sample() + 1));

  const double start_s = disturbance_.start_s;
  const double end_s = axis_.run.duration_s;
  const TimeWindow window = TimeWindow{from_s_, to_s_}.within(end_s);
  const TimeWindow transient = TimeWindow{start_s, from_s_}.within(end_s);
  WindowStatistics velocity_error(window), position_error(window), disturbance_error(window);
  WindowStatistics raw_velocity_error(window), transient_error(transient);
  WindowStatistics position(TimeWindow{}), lambda(window), any_lambda(TimeWindow{});
  WindowStatistics slowest_pole(window);
  const std::span<const double> lambda_now = published(controller, "lambda");
  const std::span<const double> poles = published(controller, "poles_continuous_re_rad_s");
  SettlingTime settling(TimeWindow{start_s, to_s_}.within_and_on(end_s),
                        settled_within_ * std::abs(disturbance_.amplitude));

  Recording recording;
  // One step more than the duration has, so that the sample at its end is there.
  recording.failure = run_loop(steps + 1, control, [&](std::int64_t) {
    rig.step();
    if (!sim.sampled()) return;
    const double t = sim.time_s();
    const double angle = sim.sample().y(0);
    raw_velocity = log.rows() == 0 ? 0.0 : (angle - last_angle) / axis_.physics.control_period_s;
    last_angle = angle;
    const double d_error = controller.disturbance() - rig.disturbance();
    velocity_error.add(t, controller.velocity() - sim.qvel()[0]);
    raw_velocity_error.add(t, raw_velocity - sim.qvel()[0]);
    position_error.add(t, controller.position() - sim.qpos()[0]);
    disturbance_error.add(t, d_error);
    transient_error.add(t, d_error);
    position.add(t, sim.qpos()[0]);
    settling.add(t, d_error);
    if (!lambda_now.empty()) {
      lambda.add(t, lambda_now.front());
      any_lambda.add(t, lambda_now.front());
    }
    if (!poles.empty()) slowest_pole.add(t, *std::max_element(poles.begin(), poles.end()));
    log.append(t);
  });

  conclude(recording, sim);
  if (!recording.failure) {
    std::vector<Metric>& metrics = recording.metrics;
    add(metrics, "rmse_velocity_rad_s", "rad/s", velocity_error.rms());
    add(metrics, "rmse_raw_velocity_rad_s", "rad/s", raw_velocity_error.rms());
    add(metrics, "rmse_position_rad", "rad", position_error.rms());
    add(metrics, "rmse_disturbance_Nm", "N m", disturbance_error.rms());
    add(metrics, "peak_position_rad", "rad", position.peak());
    if (disturbance_.kind == DisturbanceKind::step) {
      add(metrics, "disturbance_settling_time_s", "s", settling.value());
    }
    add(metrics, "transient_rmse_disturbance_Nm", "N m", transient_error.rms());
    add(metrics, "lambda_mean_1", "1", lambda.mean());
    add(metrics, "lambda_min_1", "1", any_lambda.smallest());
    add(metrics, "slowest_pole_continuous_rad_s", "rad/s", slowest_pole.mean());
  }
  recording.tracks.push_back(std::move(log));
  return recording;
}

}  // namespace breakwater
