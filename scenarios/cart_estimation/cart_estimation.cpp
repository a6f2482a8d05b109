// Scenario cart_estimation: disturbance models and forgetting factors (thesis 4.2.4).
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/world/disturbance.h>

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

// A disturbance of Table 4.3 and the end of its keys: "" or "_s" of a slope.
struct Shape {
  std::string name;
  std::string per;
  Disturbance disturbance;
};

// A cart under PD control with disturbance cancellation (Eq. 4.10), with system and observation
// noise. The question is which disturbance model and forgetting factor follow which disturbance,
// how fast, and with how much noise.
class CartEstimation final : public AxisScenario {
 public:
  explicit CartEstimation(const Catalogue& catalogue)
      : AxisScenario(catalogue, {.name = "cart_estimation",
                                 .summary = "disturbance models and forgetting factors of Kalman "
                                            "filters on a cart",
                                 .axis = cart_axis(),
                                 .controller = "pd",
                                 .reductions = lags()}) {}

  AxisPlant plant() const override {
    AxisPlant plant = plant_;
    plant.axis().force = shapes_[shape_].disturbance;
    return plant;
  }

 private:
  void bind(Fields& fields) override {
    bind_step(fields);
    std::vector<std::pair<std::string, std::size_t>> kinds;
    for (Shape& shape : shapes_) kinds.emplace_back(shape.name, kinds.size());
    fields.choice("disturbance.kind", shape_, kinds,
                  "shape of the disturbance, (a) to (d) of Table 4.3");
    for (Shape& shape : shapes_) {
      const std::string key = "disturbance." + shape.name;
      Disturbance& d = shape.disturbance;
      std::vector<std::string> keys = {key + "_N" + shape.per, key + "_start_s"};
      fields.number(keys.front(), d.amplitude, any(),
                    shape.per.empty() ? "amplitude of this disturbance [N]"
                                      : "slope of this disturbance [N/s]");
      if (d.kind == DisturbanceKind::sine) {
        keys.push_back(key + "_rad_s");
        fields.number(keys.back(), d.frequency_rad_s, positive(),
                      "frequency of this disturbance [rad/s]");
      }
      fields.number(keys[1], d.start_s, not_negative(),
                    "time at which this disturbance begins [s]");
      fields.only_for(keys, "disturbance.kind", {shape.name});
    }
    bind_window(fields, "the errors");
    fields.number("metrics.noise_from_s", noise_from_s_, not_negative(),
                  "start of the window of the noise [s]");
    fields.number("metrics.noise_to_s", noise_to_s_, not_negative(),
                  "end of the window of the noise [s]");
  }

  MetricContext complete(const Config& config) override {
    if (noise_to_s_ <= noise_from_s_) {
      config.fail("metrics.noise_to_s", "must be later than metrics.noise_from_s");
    }
    return {};
  }

  AxisAdditions additions(const AxisRig& /*rig*/, const AxisLoop& loop) const override {
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
    own.sample = [quiet, &loop, force = plant().axis().force](double time_s) {
      quiet->rate_N_s = force.rate(time_s);
      if (!loop.estimates()) return;
      quiet->noise_N = loop.estimator->disturbance()(0) - quiet->loop.estimator->disturbance()(0);
    };
    return own;
  }

  std::size_t shape_ = 0;
  std::vector<Shape> shapes_ = {{"step", "", {.kind = DisturbanceKind::step}},
                                {"ramp", "_s", {.kind = DisturbanceKind::ramp}},
                                {"sine", "", {.kind = DisturbanceKind::sine}},
                                {"high_sine", "", {.kind = DisturbanceKind::sine}}};
  double noise_from_s_ = 0.0;
  double noise_to_s_ = 0.0;
};

}  // namespace

ScenarioKind cart_estimation() {
  return scenario_kind<CartEstimation>("cart_estimation");
}

}  // namespace breakwater
