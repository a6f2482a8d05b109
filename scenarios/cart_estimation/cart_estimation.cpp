#include "cart_estimation/cart_estimation.h"

#include <cmath>
#include <utility>

#include <breakwater/math/float_environment.h>
#include <breakwater/record/window_metrics.h>

namespace breakwater {
namespace {

constexpr double kSettledWithin = 0.05;  // part of the step
constexpr double kReached = 0.99;        // part of the step

// The same cart without noise.
AxisPlant without_noise(AxisPlant plant) {
  plant.axis().noise_std = plant.axis().input_noise_std = 0.0;
  return plant;
}

// The delay of an estimate, from sums of the disturbance d, its rate and the estimate's error over
// a window. It is NaN or infinite if the window has no samples or d is constant.
class Lag {
 public:
  void add(double d, double rate, double error) {
    d_d_ += d * d;
    d_rate_ += d * rate;
    rate_rate_ += rate * rate;
    error_d_ += error * d;
    error_rate_ += error * rate;
  }

  // T of d̂(t) = d(t) − T ḋ(t) by least squares: the delay of a ramp's estimate.
  double of_pure_delay_s() const { return -error_rate_ / rate_rate_; }
  // T of d̂(t) = g d(t) − T ḋ(t): the gain g separates a wrong amplitude from a delay.
  double beside_gain_s() const {
    return -(error_rate_ - error_d_ * d_rate_ / d_d_) / (rate_rate_ - d_rate_ * d_rate_ / d_d_);
  }

 private:
  double d_d_ = 0.0;
  double d_rate_ = 0.0;
  double rate_rate_ = 0.0;
  double error_d_ = 0.0;
  double error_rate_ = 0.0;
};

}  // namespace

std::vector<MetricDefinition> CartEstimation::metric_definitions() const {
  return {{"relative_rmse_disturbance", "1",
           "root mean square error of the estimated disturbance over the root mean square of the "
           "true one, from metrics.from_s to metrics.to_s"},
          {"settling_time_5pct_s", "s",
           "for a step: time until the estimate stays within 5 % of the step"},
          {"reach_time_99pct_s", "s",
           "for a step: time until the estimate first reaches 99 % of the step"},
          {"disturbance_lag_s", "s",
           "for a ramp or a sine: delay of the estimated disturbance, fitted by least squares; for "
           "a sine, together with a gain"},
          {"max_noise_N", "N",
           "largest magnitude of the noise's part of the estimated disturbance, from "
           "metrics.noise_from_s to metrics.noise_to_s"},
          {"max_noise_deviation_N", "N",
           "largest deviation of that part from its mean, from metrics.from_s to metrics.to_s"},
          {"rms_noise_N", "N",
           "root mean square of that part, from metrics.noise_from_s to metrics.noise_to_s"},
          {"steady_state_error_m", "m",
           "mean of reference minus position, from metrics.from_s to metrics.to_s"}};
}

Fields CartEstimation::fields() {
  Fields fields;
  plant_.bind(fields);
  parts_.bind(fields);
  fields.number("task.reference_m", plant_.axis().reference.value, any(),
                "y_ref: reference of the position [m]");
  fields.number("task.reference_from_s", plant_.axis().reference.from_s, not_negative(),
                "time of the step to the reference [s]");
  fields.choice("disturbance.kind", kind_,
                {{"step", Kind::step},
                 {"ramp", Kind::ramp},
                 {"sine", Kind::sine},
                 {"high_sine", Kind::high_sine}},
                "shape of the disturbance, (a) to (d) of Table 4.3");
  const auto bind = [&fields](const std::string& name, Disturbance& d, const std::string& unit) {
    fields.number(
        "disturbance." + name + "_N" + unit, d.amplitude, any(),
        unit.empty() ? "amplitude of this disturbance [N]" : "slope of this disturbance [N/s]");
    if (d.kind == DisturbanceKind::sine) {
      fields.number("disturbance." + name + "_rad_s", d.frequency_rad_s, positive(),
                    "frequency of this disturbance [rad/s]");
    }
    fields.number("disturbance." + name + "_start_s", d.start_s, not_negative(),
                  "time at which this disturbance begins [s]");
  };
  bind("step", step_, "");
  bind("ramp", ramp_, "_s");
  bind("sine", sine_, "");
  bind("high_sine", high_sine_, "");
  const auto only_for = [&fields](const std::string& kind, const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
      fields.only_for({"disturbance." + kind + key}, "disturbance.kind", {kind});
    }
  };
  only_for("step", {"_N", "_start_s"});
  only_for("ramp", {"_N_s", "_start_s"});
  only_for("sine", {"_N", "_rad_s", "_start_s"});
  only_for("high_sine", {"_N", "_rad_s", "_start_s"});
  fields.number("metrics.from_s", from_s_, not_negative(), "start of the window of the errors [s]");
  fields.number("metrics.to_s", plant_.judged_to_s, not_negative(),
                "end of the window of the errors [s]");
  fields.number("metrics.noise_from_s", noise_from_s_, not_negative(),
                "start of the window of the noise [s]");
  fields.number("metrics.noise_to_s", noise_to_s_, not_negative(),
                "end of the window of the noise [s]");
  return fields;
}

Disturbance CartEstimation::disturbance() const {
  switch (kind_) {
    case Kind::step:
      return step_;
    case Kind::ramp:
      return ramp_;
    case Kind::sine:
      return sine_;
    case Kind::high_sine:
      return high_sine_;
  }
  return {};
}

AxisPlant CartEstimation::plant() const {
  AxisPlant plant = plant_;
  plant.axis().force = disturbance();
  return plant;
}

void CartEstimation::check(const Config& config) {
  check_plant(plant_, config);
  parts_.check(config, task());
  if (plant_.judged_to_s <= from_s_)
    config.fail("metrics.to_s", "must be later than metrics.from_s");
  if (noise_to_s_ <= noise_from_s_) {
    config.fail("metrics.noise_to_s", "must be later than metrics.noise_from_s");
  }
}

Recording CartEstimation::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const Disturbance force = disturbance();
  const AxisLoop loop = parts_.make(task());
  loop.controller->set_watched(control.logs);
  AxisRig rig(plant(), *loop.controller);
  rig.know_loop(parts_, task());
  // Also simulate the loop without noise: the difference is the effect of the noise.
  const AxisLoop quiet_loop = parts_.make(task());
  quiet_loop.controller->set_watched(false);
  AxisRig quiet_rig(without_noise(plant()), *quiet_loop.controller);
  double noise_N = 0.0;
  const Simulation& sim = rig.simulation();
  std::vector<Signal> signals = rig.signals();
  signals.push_back({"d_hat_noise_N", "N",
                     "part of the estimated disturbance that the noise causes", view(noise_N)});

  const double end_s = plant_.run.duration_s;
  const TimeWindow window = TimeWindow{from_s_, plant_.judged_to_s}.within(end_s);
  WindowStatistics error(window), truth(window), position_error(window), noise_in_window(window);
  const TimeWindow noise_window = TimeWindow{noise_from_s_, noise_to_s_}.within(end_s);
  WindowStatistics noise(noise_window);
  // The fit of a sine's delay and gain needs the whole settled time.
  const TimeWindow& lag_window = kind_ == Kind::ramp ? window : noise_window;
  Lag lag;
  SettlingTime settling(TimeWindow{force.start_s, plant_.judged_to_s}.within_and_on(end_s),
                        kSettledWithin * std::abs(force.amplitude));
  ReachTime reach(force.start_s, kReached * std::abs(force.amplitude));

  const auto step = [&](std::int64_t) {
    rig.step();
    quiet_rig.step();
  };
  const auto sample = [&](double t) {
    truth.add(t, rig.disturbance());
    position_error.add(t, plant_.axis().reference.at(t) - sim.qpos()[0]);
    if (!loop.estimates()) return;
    const double d_hat = loop.estimator->disturbance()(0);
    const double d_error = d_hat - rig.disturbance();
    error.add(t, d_error);
    if (lag_window.contains(t)) lag.add(rig.disturbance(), force.rate(t), d_error);
    noise_N = d_hat - quiet_loop.estimator->disturbance()(0);
    noise.add(t, noise_N);
    noise_in_window.add(t, noise_N);
    settling.add(t, d_error);
    reach.add(t, d_hat);
  };
  const auto measured = [&] {
    std::vector<Metric> metrics;
    if (error.rms() && truth.rms().value_or(0.0) > 0.0) {
      add(metrics, "relative_rmse_disturbance", "1", *error.rms() / *truth.rms());
    }
    if (kind_ == Kind::step) {
      add(metrics, "settling_time_5pct_s", "s", settling.value());
      add(metrics, "reach_time_99pct_s", "s", reach.value());
    }
    if (kind_ == Kind::ramp) add(metrics, "disturbance_lag_s", "s", lag.of_pure_delay_s());
    if (kind_ == Kind::sine || kind_ == Kind::high_sine) {
      add(metrics, "disturbance_lag_s", "s", lag.beside_gain_s());
    }
    add(metrics, "max_noise_N", "N", noise.peak());
    add(metrics, "max_noise_deviation_N", "N", noise_in_window.largest_deviation());
    add(metrics, "rms_noise_N", "N", noise.rms());
    add(metrics, "steady_state_error_m", "m", position_error.mean());
    return metrics;
  };
  return rig.run(control, std::move(signals), step, sample, measured);
}

}  // namespace breakwater
