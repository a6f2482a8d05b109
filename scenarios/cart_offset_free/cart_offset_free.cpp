#include "cart_offset_free/cart_offset_free.h"

#include <cmath>
#include <utility>

#include <breakwater/math/float_environment.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/rigs/predictive_settings.h>

namespace breakwater {

std::vector<MetricDefinition> CartOffsetFree::metric_definitions() const {
  return with_qp_metrics(
      {{"steady_state_error_m", "m",
        "mean of measured position minus reference, from metrics.from_s to metrics.to_s"},
       {"true_position_error_m", "m", "mean of true position minus reference, in the same window"},
       {"settling_time_s", "s",
        "time from the step of the reference until the measured position stays within "
        "metrics.settled_within times the reference, before the disturbance begins"},
       {"max_speed_m_s", "m/s", "largest magnitude of the velocity"},
       {"max_input_N", "N", "largest magnitude of the commanded force"},
       {"max_position_m", "m", "largest position"},
       {"std_position_m", "m",
        "standard deviation of the position, from metrics.from_s to metrics.to_s"},
       {"rms_position_estimate_error_m", "m", "root mean square of estimated minus true position"},
       {"max_early_disturbance_estimate_N", "N",
        "largest magnitude of the estimated disturbance between the step of the reference and the "
        "start "
        "of the disturbance"},
       {"mean_disturbance_estimate_N", "N",
        "mean of the estimated disturbance, from metrics.from_s to metrics.to_s"},
       {"rms_disturbance_error_N", "N",
        "root mean square of estimated minus true disturbance, from metrics.from_s to "
        "metrics.to_s"}});
}

Fields CartOffsetFree::fields() {
  Fields fields;
  plant_.bind(fields);
  fields.flag("noise.enabled", noise_, "add the noise");
  fields.only_where({"noise.std_m", "noise.input_std_N"}, "noise.enabled is true",
                    [this] { return noise_; });
  parts_.bind(fields);
  fields.number("reference.position_m", plant_.axis().reference.value, any(),
                "r: reference of the position [m]");
  fields.number("reference.start_s", plant_.axis().reference.from_s, not_negative(),
                "time of the step of the reference from 0 to r [s]");
  fields.number("disturbance.input_N", disturbance_N_, any(),
                "d_i: input disturbance, which opposes the drive [N]");
  fields.number("disturbance.output_m", output_disturbance_m_, any(),
                "d_o: output disturbance, added to the measured position [m]");
  fields.number("disturbance.start_s", disturbance_start_s_, not_negative(),
                "time at which both disturbances begin [s]");
  fields.number("metrics.from_s", from_s_, not_negative(),
                "start of the window of the means of the errors [s]");
  fields.number("metrics.to_s", plant_.judged_to_s, not_negative(),
                "end of the window of the means of the errors [s]");
  fields.number("metrics.settled_within", settled_within_, positive(),
                "relative distance from r within which y counts as settled before the disturbance");
  return fields;
}

AxisPlant CartOffsetFree::plant() const {
  AxisPlant plant = plant_;
  AxisSettings& axis = plant.axis();
  if (!noise_) axis.noise_std = axis.input_noise_std = 0.0;
  const auto step = [&](double amplitude) {
    return Disturbance{DisturbanceKind::step, amplitude, 0.0, disturbance_start_s_};
  };
  axis.force = step(disturbance_N_);
  axis.output = step(output_disturbance_m_);
  return plant;
}

void CartOffsetFree::check(const Config& config) {
  check_plant(plant_, config);
  parts_.check(config, task());
  if (plant_.judged_to_s <= from_s_)
    config.fail("metrics.to_s", "must be later than metrics.from_s");
}

Recording CartOffsetFree::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const AxisLoop loop = parts_.make(task());
  AxisRig rig(plant(), *loop.controller);
  rig.know_loop(parts_, task());
  const Simulation& sim = rig.simulation();

  const double end_s = plant_.run.duration_s;
  const TimeWindow window = TimeWindow{from_s_, plant_.judged_to_s}.within(end_s);
  WindowStatistics error(window), true_error(window), d_hat(window), d_error(window);
  WindowStatistics position_in_window(window), estimate_error(TimeWindow{});
  const Reference& reference = plant_.axis().reference;
  WindowStatistics early_d_hat(TimeWindow{reference.from_s}.within(end_s));
  WindowStatistics speed(TimeWindow{}), input(TimeWindow{}), position(TimeWindow{});
  SettlingTime settling(TimeWindow{reference.from_s, disturbance_start_s_}.within(end_s),
                        settled_within_ * std::abs(reference.value));

  const auto sample = [&](double t) {
    const double r = reference.at(t);
    const double y = sim.sample().y(0);
    error.add(t, y - r);
    true_error.add(t, sim.qpos()[0] - r);
    speed.add(t, sim.qvel()[0]);
    input.add(t, sim.command()(0));
    position.add(t, sim.qpos()[0]);
    position_in_window.add(t, sim.qpos()[0]);
    if (t < disturbance_start_s_) settling.add(t, y - r);
    if (!loop.estimates()) return;
    const double estimate = loop.estimator->disturbance()(0);
    d_hat.add(t, estimate);
    d_error.add(t, estimate - rig.disturbance());
    estimate_error.add(t, loop.estimator->state()(0) - sim.qpos()[0]);
    if (t < disturbance_start_s_) early_d_hat.add(t, estimate);
  };
  const auto measured = [&] {
    std::vector<Metric> metrics;
    add(metrics, "steady_state_error_m", "m", error.mean());
    add(metrics, "true_position_error_m", "m", true_error.mean());
    add(metrics, "settling_time_s", "s", settling.value());
    add(metrics, "max_speed_m_s", "m/s", speed.peak());
    add(metrics, "max_input_N", "N", input.peak());
    add(metrics, "max_position_m", "m", position.largest());
    add(metrics, "std_position_m", "m", position_in_window.standard_deviation());
    add(metrics, "rms_position_estimate_error_m", "m", estimate_error.rms());
    add(metrics, "max_early_disturbance_estimate_N", "N", early_d_hat.peak());
    add(metrics, "mean_disturbance_estimate_N", "N", d_hat.mean());
    add(metrics, "rms_disturbance_error_N", "N", d_error.rms());
    return metrics;
  };
  Recording recording = rig.run(control, rig.signals(), sample, measured);
  if (!recording.failure) add_qp_metrics(*loop.controller, recording);
  return recording;
}

}  // namespace breakwater
