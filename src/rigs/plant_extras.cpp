#include <breakwater/rigs/plant_extras.h>

#include <numbers>
#include <utility>

#include <breakwater/config/column_table.h>
#include <breakwater/experiment/settings.h>
#include <breakwater/sim/model.h>

namespace breakwater {

void PushSettings::bind(Fields& fields) {
  const Fields::Under under(fields, prefix());
  fields.text("body", body, "body of the model that the force pushes at its centre of mass");
  fields.numbers("along", along, any(), "direction of the force in the world, of any length");
  disturbance.bind(fields, "N", "N");
  for (const char* key : {"disturbance.frequency_rad_s", "disturbance.start_s"}) {
    fields.standard(key, {0.0});
  }
}

void TipSettings::bind(Fields& fields) {
  fields.optional_text(
      "tip.contact", contact,
      "name of the contact whose normal force is force_true_N; none: there is no such "
      "signal");
  fields.optional_text(
      "tip.sensor", sensor,
      "<force> or <touch> of the model that measures the force; none: the force of "
      "tip.contact is measured");
  fields.optional_count(
      "tip.component", component, between(0, 2),
      "value of the sensor, from 0: 0 is the force with which the tip presses along x of its site");
  chain.bind_filter(fields);
  chain.bind_noise(fields);
  chain.bind(fields);
  fields.optional_number("force.reference_N", reference.value, any(),
                         "reference of the force, for the controller and the log [N]");
  fields.optional_number("force.from_s", reference.from_s, not_negative(),
                         "time from which the reference counts; before, it is 0 [s]");
  fields.standard("force.filter_time_constant_s", {0.0});
  fields.standard("sensor.force_noise_N", {0.0});
  fields.only_where({"tip.component", "sensor.force_tool_mass_kg", "sensor.force_weighed_kg"},
                    "tip.sensor names a sensor", [this] { return sensor != kNone; });
}

void TipSettings::add_tool(Model& model) const {
  if (sensor == kNone || chain.tool_mass_kg == 0.0) return;
  const int id = model.id(mjOBJ_SENSOR, sensor);
  model.add_mass(model->site_bodyid[model->sensor_objid[id]], chain.tool_mass_kg);
}

void DisturbanceSettings::bind(Fields& fields, const std::string& suffix, const std::string& unit) {
  const char* const kind = "disturbance.kind";
  const std::string amplitude = "disturbance.amplitude_" + suffix;
  const std::string second = "disturbance.second_amplitude_" + suffix;
  fields.choice(kind, shape.kind,
                {{"none", DisturbanceKind::none},
                 {"step", DisturbanceKind::step},
                 {"ramp", DisturbanceKind::ramp},
                 {"sine", DisturbanceKind::sine},
                 {"two_sines", DisturbanceKind::two_sines},
                 {"chirp", DisturbanceKind::chirp},
                 {"noise", DisturbanceKind::noise},
                 {"csv", DisturbanceKind::csv}},
                "shape of the disturbance");
  fields.number(
      amplitude, shape.amplitude, any(),
      "amplitude of a step, sine or chirp [" + unit + "]; slope of a ramp [" + unit + "/s]");
  fields.number(
      "disturbance.frequency_rad_s", shape.frequency_rad_s, any(),
      "frequency of a sine, of the first of two sines, or of a chirp at its start [rad/s]");
  fields.only_for({amplitude}, kind,
                  {"step", "ramp", "sine", "two_sines", "chirp", "noise", "csv"});
  fields.only_for({"disturbance.frequency_rad_s"}, kind, {"sine", "two_sines", "chirp"});
  const auto bind_for = [&](const std::string& one, const std::string& key, double& target,
                            double standard, const Range& range, const std::string& doc) {
    fields.number(key, target, range, doc);
    fields.standard(key, {standard});
    fields.only_for({key}, kind, {one});
  };
  bind_for("two_sines", second, shape.second_amplitude, 2.0, any(),
           "amplitude of the second sine [" + unit + "]");
  bind_for("two_sines", "disturbance.second_frequency_rad_s", shape.second_frequency_rad_s, 5.0,
           any(), "frequency of the second sine [rad/s]");
  bind_for("chirp", "disturbance.end_frequency_rad_s", shape.end_frequency_rad_s, 5.0, any(),
           "frequency that a chirp reaches at a constant rate and then keeps [rad/s]");
  bind_for("chirp", "disturbance.sweep_s", shape.sweep_s, 9.0, positive(),
           "time that a chirp takes to reach its last frequency [s]");
  fields.number("disturbance.start_s", shape.start_s, not_negative(),
                "time at which the disturbance begins [s]");
  fields.optional_number(
      "disturbance.end_s", end_s, not_negative(),
      "time at which the disturbance ends; a step between both times is a pulse; 0: the "
      "end of the run [s]");
  const std::string offset = "disturbance.offset_" + suffix;
  fields.optional_number(offset, shape.offset, any(),
                         "constant part, from the start of the run [" + unit + "]");
  {
    const Fields::OfPart noise(fields, kind, "noise");
    fields.number("disturbance.hold_s", shape.hold_s, positive(),
                  "time for which each number of the noise lasts; the amplitude is its standard "
                  "deviation [s]");
  }
  const Fields::OfPart csv(fields, kind, "csv");
  fields.file(
      "disturbance.file", file,
      "table with the columns time_s, from the start, and value, a factor on the amplitude; "
      "linear between its rows, with the last value after them");
}

void DisturbanceSettings::load(const Config& config) {
  if (end_s != 0.0 && end_s <= shape.start_s) {
    config.fail("disturbance.end_s",
                "must be later than disturbance.start_s, or 0 for the end of the run");
  }
  if (shape.kind != DisturbanceKind::csv) return;
  config.blame("disturbance.file", [&] { shape.table = read_function(file, "value"); });
}

Disturbance DisturbanceSettings::make(std::uint64_t seed, const std::string& channel) const {
  Disturbance made = shape;
  if (end_s != 0.0) made.end_s = end_s;
  if (made.kind == DisturbanceKind::noise) made.noise.emplace(seed, channel);
  return made;
}

void ForceSensorSettings::bind_filter(Fields& fields) {
  fields.number("force.filter_time_constant_s", low_pass_s, not_negative(),
                "time constant of the force sensor's low-pass; 0: none [s]");
}

void ForceSensorSettings::bind_noise(Fields& fields) {
  fields.number("sensor.force_noise_N", raw.noise_std, not_negative(),
                "standard deviation of white noise on each force sample [N]");
}

void ForceSensorSettings::bind(Fields& fields) {
  fields.optional_number(
      "sensor.force_tool_mass_kg", tool_mass_kg, not_negative(),
      "mass before the force sensor beside the tip's own: the sensor reads its inertia [kg]");
  fields.optional_number("sensor.force_resonance_Hz", resonance_Hz, not_negative(),
                         "natural frequency of the sensor's body; 0: rigid [Hz]");
  fields.optional_number("sensor.force_damping_ratio", raw.body.damping_ratio, between(0.0, 0.99),
                         "damping ratio of the sensor's body");
  fields.only_where({"sensor.force_damping_ratio"}, "sensor.force_resonance_Hz is not 0",
                    [this] { return resonance_Hz != 0.0; });
  fields.optional_number("sensor.force_bias_N", raw.electronics.bias, any(),
                         "constant error of the sensor [N]");
  fields.optional_number("sensor.force_drift_N_sqrt_s", raw.electronics.drift_per_sqrt_s,
                         not_negative(),
                         "drift, a random walk: its standard deviation after 1 s [N/s^0.5]");
  fields.optional_number("sensor.force_range_N", raw.electronics.range, not_negative(),
                         "range: larger forces of either sign are clipped; 0: no limit [N]");
  fields.optional_number("sensor.force_quantum_N", raw.electronics.quantum, not_negative(),
                         "one step of the converter; 0: no quantisation [N]");
  fields.optional_number("sensor.force_period_s", raw.electronics.period_s, not_negative(),
                         "the sensor's own sampling period; 0: physics.timestep_s [s]");
  fields.optional_number("sensor.force_delay_s", raw.electronics.delay_s, not_negative(),
                         "delay of the sensor's samples [s]");
  fields.optional_number(
      "sensor.force_weighed_kg", raw.weighed_kg, between(SensorChannel::kAllBeyond, 1e3),
      "mass beyond the sensor whose weight is taken off each sample, as the sensor is turned; "
      "negative: all that the model has there [kg]");
  fields.optional_number(
      "sensor.force_tare_at_s", raw.tare_at_s, between(SensorChannel::kNever, 1e9),
      "time whose value, before noise, is taken off all samples from then on; -1: none [s]");
}

void ForceSensorSettings::check(const Config& config, double timestep_s) const {
  check_multiple(config, "sensor.force_period_s", raw.electronics.period_s, timestep_s,
                 "physics.timestep_s");
  check_multiple(config, "sensor.force_delay_s", raw.electronics.delay_s, timestep_s,
                 "physics.timestep_s");
}

std::array<SensorChannel, 2> ForceSensorSettings::channels() const {
  SensorChannel before = raw;
  before.name = "force_raw";
  before.body.resonance_rad_s = 2.0 * std::numbers::pi * resonance_Hz;
  SensorChannel behind = before;
  behind.name = "force";
  behind.low_pass_s = low_pass_s;
  return {std::move(behind), std::move(before)};
}

}  // namespace breakwater
