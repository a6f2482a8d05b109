// Scenario motor_estimation: disturbance estimators behind an encoder (thesis 4.3).
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/plant_extras.h>

namespace breakwater {
namespace {

// PD control with disturbance cancellation (Eq. 4.22) holds a motor at 0. Its angle comes from an
// encoder, with or without white noise, and a torque disturbs it. The question is how well the
// estimator finds velocity and disturbance.
class MotorEstimation final : public AxisScenario {
 public:
  explicit MotorEstimation(const Catalogue& catalogue)
      : AxisScenario(
            catalogue,
            {.name = "motor_estimation",
             .summary = "disturbance estimators on a motor: encoder quantisation and white noise",
             .axis = motor_axis(),
             .controller = "pd"}) {}

  AxisPlant plant() const override {
    AxisPlant plant = plant_;
    plant.axis().force = disturbance_.make(plant.run.seed, "disturbance");
    return plant;
  }

 private:
  void bind(Fields& fields) override { disturbance_.bind(fields, "Nm", "N m"); }

  MetricContext complete(const Config& config) override {
    disturbance_.load(config);
    return {};
  }

  // For comparison with tables of a differentiated encoder. The controller does not use it.
  AxisAdditions additions(const AxisRig& rig, const AxisLoop& /*loop*/) const override {
    struct Raw {
      double velocity = 0.0;
      double last_angle = 0.0;
      double measurement_error = 0.0;
    };
    const auto raw = std::make_shared<Raw>();
    AxisAdditions own;
    own.logged = {
        {"velocity_raw_rad_s", "rad/s",
         "raw difference of the measured angle over a sample; 0 at the first", view(raw->velocity)},
        {"measurement_error_rad", "rad", "sampled minus true angle", view(raw->measurement_error)}};
    own.sample = [raw, &rig, period_s = plant_.physics.control_period_s](double /*time_s*/) {
      const double angle = rig.measured();
      raw->velocity = rig.simulation().steps() == 1 ? 0.0 : (angle - raw->last_angle) / period_s;
      raw->last_angle = angle;
      raw->measurement_error = angle - rig.position();
    };
    return own;
  }

  DisturbanceSettings disturbance_;
};

}  // namespace

ScenarioKind motor_estimation() {
  return scenario_kind<MotorEstimation>("motor_estimation");
}

}  // namespace breakwater
