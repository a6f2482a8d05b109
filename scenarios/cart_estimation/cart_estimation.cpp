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

// The delay T of an estimate by least squares: d̂(t) = d(t) − T ḋ(t), the delay of a ramp's
// estimate. With a gain it is d̂(t) = g d(t) − T ḋ(t): the gain separates a wrong amplitude from a
// delay. T is NaN or infinite if d is constant. The values are d̂, d and the rate of d.
template <bool has_gain>
class Lag final : public Reduction {
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
  std::optional<double> value() const override {
    if (!has_gain) return -error_rate_ / rate_rate_;
    return -(error_rate_ - error_d_ * d_rate_ / d_d_) / (rate_rate_ - d_rate_ * d_rate_ / d_d_);
  }

 private:
  double d_d_ = 0.0;
  double d_rate_ = 0.0;
  double rate_rate_ = 0.0;
  double error_d_ = 0.0;
  double error_rate_ = 0.0;
};

std::vector<MetricKind> lags() {
  MetricKind lag{.name = "lag",
                 .meaning = "delay of an estimate, by least squares",
                 .unit = ReducedUnit::time,
                 .make = make_reduction<Lag<false>>,
                 .takes_all = true};
  MetricKind beside_gain = lag;
  beside_gain.name += "_beside_gain";
  beside_gain.meaning += ", together with a gain";
  beside_gain.make = make_reduction<Lag<true>>;
  return {lag, beside_gain};
}

// A disturbance of Table 4.3.
struct Shape {
  std::string name;
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
    plant_.axis().bind_step(fields);
    std::vector<std::pair<std::string, std::size_t>> kinds;
    for (Shape& shape : shapes_) kinds.emplace_back(shape.name, kinds.size());
    fields.choice("disturbance.kind", shape_, kinds,
                  "shape of the disturbance, (a) to (d) of Table 4.3");
    for (Shape& shape : shapes_) {
      Disturbance& d = shape.disturbance;
      const auto only = [&](const std::string& end, double& target, const Range& range,
                            const std::string& doc) {
        const std::string key = "disturbance." + shape.name + end;
        fields.number(key, target, range, doc);
        fields.only_for({key}, "disturbance.kind", {shape.name});
      };
      if (d.kind == DisturbanceKind::ramp) {
        only("_N_s", d.amplitude, any(), "slope of this disturbance [N/s]");
      } else {
        only("_N", d.amplitude, any(), "amplitude of this disturbance [N]");
      }
      if (d.kind == DisturbanceKind::sine) {
        only("_rad_s", d.frequency_rad_s, positive(), "frequency of this disturbance [rad/s]");
      }
      only("_start_s", d.start_s, not_negative(), "time at which this disturbance begins [s]");
    }
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
    const auto quiet = std::make_shared<Quiet>(parts(), task(), without_noise(plant()));
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
  std::vector<Shape> shapes_ = {{"step", {.kind = DisturbanceKind::step}},
                                {"ramp", {.kind = DisturbanceKind::ramp}},
                                {"sine", {.kind = DisturbanceKind::sine}},
                                {"high_sine", {.kind = DisturbanceKind::sine}}};
};

}  // namespace

ScenarioKind cart_estimation() {
  return scenario_kind<CartEstimation>("cart_estimation");
}

}  // namespace breakwater
