#include "cart_offset_free/cart_offset_free.h"

namespace breakwater {

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
  rows_.bind(fields);
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
  check_metrics(config);
}

}  // namespace breakwater
