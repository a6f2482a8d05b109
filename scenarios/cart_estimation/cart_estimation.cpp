// Scenario cart_estimation: disturbance models and forgetting factors (thesis 4.2.4).
#include <breakwater/math/functions.h>
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/world/disturbance.h>

namespace breakwater {
namespace {

// The delay T of an estimate by least squares. For a ramp it is that of d̂(t) = d(t) − T ḋ(t). For a
// sine, whose frequency is the level, it is that of d̂(t) = g d(t − T). T is NaN or infinite if d is
// constant. The values are d̂, d and the rate of d.
class Lag final : public Reduction {
 public:
  using Reduction::Reduction;
  void add(const AddedValues& added) override {
    const Eigen::Vector2d d(added.all[1], added.all[2]);
    d_d_ += d * d.transpose();
    error_d_ += (added.all[0] - d(0)) * d;
  }
  std::optional<double> value() const override {
    if (omega_rad_s_ == 0.0) return -error_d_(1) / d_d_(1, 1);
    // g d(t − T) = g cos(ω T) d(t) − g sin(ω T)/ω ḋ(t)
    const Eigen::Vector2d fit = d_d_.inverse() * error_d_;
    return math::atan2(-omega_rad_s_ * fit(1), 1.0 + fit(0)) / omega_rad_s_;
  }

 private:
  const double omega_rad_s_ = setup_.level.value();
  Eigen::Matrix2d d_d_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d error_d_ = Eigen::Vector2d::Zero();
};

// A cart under PD control with disturbance cancellation (Eq. 4.10), with system and observation
// noise. The question is which disturbance model and forgetting factor follow which disturbance,
// how fast, and with how much noise.
class CartEstimation final : public AxisScenario {
 public:
  explicit CartEstimation(const Catalogue& catalogue)
      : AxisScenario(
            catalogue,
            {.name = "cart_estimation",
             .summary = "disturbance models and forgetting factors of Kalman "
                        "filters on a cart",
             .axis = cart_axis(),
             .controller = "pd",
             .reductions = {{.name = "lag",
                             .meaning = "delay of an estimate, by least squares; of a sine, whose "
                                        "frequency is the level, together with a gain",
                             .unit = "s",
                             .make = make_reduction<Lag>,
                             .has_level = true,
                             .takes_all = true}}}) {
    plant_.axis().has_disturbance_keys = false;
  }

 private:
  void bind(Fields& fields) override {
    fields.choice<std::size_t>("disturbance.kind", shape_,
                               {{"step", 0}, {"ramp", 1}, {"sine", 2}, {"high_sine", 3}},
                               "shape of the disturbance, (a) to (d) of Table 4.3");
    for (auto& [name, d] : shapes_) {
      const Fields::OfPart shape(fields, "disturbance.kind", name);
      const std::string key = "disturbance." + name;
      const bool is_ramp = d.kind == DisturbanceKind::ramp;
      fields.number(key + (is_ramp ? "_N_s" : "_N"), d.amplitude, any(),
                    is_ramp ? "slope of this disturbance" : "amplitude of this disturbance");
      if (d.kind == DisturbanceKind::sine) {
        fields.number(key + "_rad_s", d.frequency_rad_s, positive(),
                      "frequency of this disturbance");
      }
      fields.number(key + "_start_s", d.start_s, not_negative(),
                    "time at which this disturbance begins");
    }
  }

  MetricContext complete(const Config& /*config*/) override {
    plant_.axis().force = shapes_[shape_].second;
    return {};
  }

  void extend(RigRun& run, AxisRig& rig, const AxisLoop& loop) const override {
    // Also simulate the loop without noise: the difference is the effect of the noise.
    AxisPlant plant = plant_;
    plant.axis().has_noise = false;
    const auto quiet = std::make_shared<AxisLoop>(parts().make(task()));
    quiet->controller->set_watched(false);
    const auto quiet_rig = std::make_shared<AxisRig>(plant, *quiet->controller);
    run.compute("d_hat_noise_N", "N", "part of the estimated disturbance that the noise causes",
                [quiet, quiet_rig, &rig, &loop](double, auto) {
                  while (quiet_rig->simulation().steps() < rig.simulation().steps()) {
                    quiet_rig->step();
                  }
                  if (!loop.estimates()) return 0.0;
                  return loop.estimator->disturbance()(0) - quiet->estimator->disturbance()(0);
                });
    run.compute("d_rate_N_s", "N/s", "",
                [this](double time_s, auto) { return plant_.axis().force.rate(time_s); });
  }

  std::size_t shape_ = 0;
  std::vector<std::pair<std::string, Disturbance>> shapes_ = {
      {"step", {.kind = DisturbanceKind::step}},
      {"ramp", {.kind = DisturbanceKind::ramp}},
      {"sine", {.kind = DisturbanceKind::sine}},
      {"high_sine", {.kind = DisturbanceKind::sine}}};
};

}  // namespace

ScenarioKind cart_estimation() {
  return scenario_kind<CartEstimation>("cart_estimation", true);
}

}  // namespace breakwater
