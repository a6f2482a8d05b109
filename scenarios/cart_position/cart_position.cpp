#include "cart_position/cart_position.h"

#include <cmath>
#include <utility>

#include <breakwater/linear/high_pass.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/rigs/predictive_settings.h>

namespace breakwater {
namespace {

const double kRisen = 1.0 - std::exp(-1.0);  // part of the Coulomb friction after one time constant

}  // namespace

std::vector<MetricDefinition> CartPosition::metric_definitions() const {
  return with_qp_metrics(
      {{"steady_state_error_m", "m",
        "mean of reference minus position, from metrics.from_s to metrics.to_s"},
       {"settling_time_s", "s",
        "time from the step of the reference until the error stays within metrics.settled_within "
        "times the step"},
       {"estimate_rise_time_s", "s",
        "time from the step of the reference until the estimated disturbance first reaches 63.2 % "
        "of the Coulomb friction"},
       {"rms_highpass_disturbance_N", "N",
        "root mean square of the estimated disturbance behind the high-pass metrics.high_pass_Hz"},
       {"rms_input_step_N", "N",
        "root mean square of the change of the applied force from sample to sample, from "
        "metrics.from_s to metrics.to_s"},
       {"max_position_m", "m", "largest position"}});
}

Fields CartPosition::fields() {
  Fields fields;
  plant_.bind(fields);
  parts_.bind(fields);
  fields.number("task.reference_m", plant_.axis().reference.value, any(),
                "y_ref: reference of the position [m]");
  fields.number("task.reference_from_s", plant_.axis().reference.from_s, not_negative(),
                "time of the step to the reference [s]");
  fields.number("metrics.from_s", from_s_, not_negative(),
                "start of the window of the steady state [s]");
  fields.number("metrics.to_s", plant_.judged_to_s, not_negative(),
                "end of the window of the steady state [s]");
  fields.number(
      "metrics.settled_within", settled_within_, positive(),
      "distance from the reference, relative to the step, within which the cart counts as settled");
  fields.number(
      "metrics.high_pass_Hz", high_pass_Hz_, positive(),
      "passband of the high-pass behind which the noise of the estimate is measured [Hz]");
  return fields;
}

void CartPosition::check(const Config& config) {
  check_plant(plant_, config);
  parts_.check(config, task());
  config.blame("metrics.high_pass_Hz",
               [&] { HighPass(high_pass_Hz_, plant_.physics.control_period_s); });
  if (plant_.judged_to_s <= from_s_)
    config.fail("metrics.to_s", "must be later than metrics.from_s");
}

Recording CartPosition::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const AxisLoop loop = parts_.make(task());
  loop.controller->set_watched(control.logs);
  AxisRig rig(plant_, *loop.controller);
  rig.know_loop(parts_, task());
  const Simulation& sim = rig.simulation();

  HighPass high_pass(high_pass_Hz_, plant_.physics.control_period_s);
  double high_passed_N = 0.0;
  std::vector<Signal> signals = rig.signals();
  signals.push_back({"d_hat_highpass_N", "N", "the estimated disturbance behind a high-pass",
                     view(high_passed_N)});

  const double end_s = plant_.run.duration_s;
  const TimeWindow window = TimeWindow{from_s_, plant_.judged_to_s}.within(end_s);
  WindowStatistics error(window), input_step(window), noise(TimeWindow{}), position(TimeWindow{});
  double last_input = 0.0;
  const Reference& reference = plant_.axis().reference;
  ReachTime rise(reference.from_s, kRisen * plant_.axis().coulomb_friction);
  SettlingTime settling(TimeWindow{reference.from_s, plant_.judged_to_s}.within_and_on(end_s),
                        settled_within_ * std::abs(reference.value));

  const auto sample = [&](double t) {
    if (loop.estimates()) {
      const double d_hat = loop.estimator->disturbance()(0);
      rise.add(t, d_hat);
      high_passed_N = high_pass.update(d_hat);
      noise.add(t, high_passed_N);
    }
    const double missing = reference.at(t) - sim.qpos()[0];
    const double input = sim.actuation()(0);
    error.add(t, missing);
    settling.add(t, missing);
    position.add(t, sim.qpos()[0]);
    input_step.add(t, input - last_input);
    last_input = input;
  };
  const auto measured = [&] {
    std::vector<Metric> metrics;
    add(metrics, "steady_state_error_m", "m", error.mean());
    add(metrics, "settling_time_s", "s", settling.value());
    add(metrics, "estimate_rise_time_s", "s", rise.value());
    add(metrics, "rms_highpass_disturbance_N", "N", noise.rms());
    add(metrics, "rms_input_step_N", "N", input_step.rms());
    add(metrics, "max_position_m", "m", position.largest());
    return metrics;
  };
  Recording recording = rig.run(control, std::move(signals), sample, measured);
  if (!recording.failure) add_qp_metrics(*loop.controller, recording);
  return recording;
}

}  // namespace breakwater
