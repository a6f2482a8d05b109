#include "motor_estimation/motor_estimation.h"

namespace breakwater {

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
  rows_.bind(fields);
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
  check_metrics(config);
}

// For comparison with tables of a differentiated encoder. The controller does not use it.
AxisAdditions MotorEstimation::additions(const AxisRig& rig, const AxisLoop& /*loop*/) const {
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

}  // namespace breakwater
