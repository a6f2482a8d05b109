#include "cart_estimation/cart_estimation.h"

namespace breakwater {
namespace {

// The same cart without noise.
AxisPlant without_noise(AxisPlant plant) {
  plant.axis().noise_std = plant.axis().input_noise_std = 0.0;
  return plant;
}

// The delay of an estimate, from sums of the disturbance d, its rate and the estimate's error over
// a window. It is NaN or infinite if d is constant. The values are d̂, d and the rate of d.
class Lag : public Reduction {
 public:
  explicit Lag(const ReductionSetup& /*setup*/) {}
  void add(const AddedValues& added) override {
    const double d = added.all[1], rate = added.all[2], error = added.all[0] - d;
    d_d_ += d * d;
    d_rate_ += d * rate;
    rate_rate_ += rate * rate;
    error_d_ += error * d;
    error_rate_ += error * rate;
  }
  // T of d̂(t) = d(t) − T ḋ(t) by least squares: the delay of a ramp's estimate.
  std::optional<double> value() const override { return -error_rate_ / rate_rate_; }

 protected:
  double d_d_ = 0.0;
  double d_rate_ = 0.0;
  double rate_rate_ = 0.0;
  double error_d_ = 0.0;
  double error_rate_ = 0.0;
};

// T of d̂(t) = g d(t) − T ḋ(t): the gain g separates a wrong amplitude from a delay.
class LagBesideGain final : public Lag {
 public:
  using Lag::Lag;
  std::optional<double> value() const override {
    return -(error_rate_ - error_d_ * d_rate_ / d_d_) / (rate_rate_ - d_rate_ * d_rate_ / d_d_);
  }
};

std::vector<MetricKind> lags() {
  return {{.name = "lag",
           .meaning = "delay of an estimate, by least squares",
           .unit = ReducedUnit::time,
           .make = make_reduction<Lag>,
           .takes_all = true},
          {.name = "lag_beside_gain",
           .meaning = "delay of an estimate, by least squares, together with a gain",
           .unit = ReducedUnit::time,
           .make = make_reduction<LagBesideGain>,
           .takes_all = true}};
}

}  // namespace

CartEstimation::CartEstimation(const Catalogue& catalogue)
    : AxisScenario(MetricRows(catalogue, "cart_estimation", lags()), Optimises::no),
      plant_(cart_axis(), catalogue),
      parts_(catalogue, "pd") {}

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
  rows_.bind(fields);
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
  check_metrics(config);
}

AxisAdditions CartEstimation::additions(const AxisRig& /*rig*/, const AxisLoop& loop) const {
  // Also simulate the loop without noise: the difference is the effect of the noise.
  struct Quiet {
    Quiet(const AxisParts& parts, const AxisTask& task, const AxisPlant& plant)
        : loop(parts.make(task)), rig(plant, *loop.controller) {}

    AxisLoop loop;
    AxisRig rig;
    double noise_N = 0.0;
    double rate_N_s = 0.0;
  };
  const auto quiet = std::make_shared<Quiet>(parts_, task(), without_noise(plant()));
  quiet->loop.controller->set_watched(false);
  AxisAdditions own;
  own.logged = {{"d_hat_noise_N", "N", "part of the estimated disturbance that the noise causes",
                 view(quiet->noise_N)}};
  own.unlogged = {{"d_rate_N_s", "N/s", "rate of the disturbance", view(quiet->rate_N_s)}};
  own.step = [quiet] { quiet->rig.step(); };
  own.sample = [quiet, &loop, force = disturbance()](double time_s) {
    quiet->rate_N_s = force.rate(time_s);
    if (!loop.estimates()) return;
    quiet->noise_N = loop.estimator->disturbance()(0) - quiet->loop.estimator->disturbance()(0);
  };
  return own;
}

}  // namespace breakwater
