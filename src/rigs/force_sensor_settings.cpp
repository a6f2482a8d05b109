#include <breakwater/rigs/force_sensor_settings.h>

#include <numbers>
#include <utility>

#include <breakwater/experiment/settings.h>

namespace breakwater {

void ForceSensorSettings::bind_filter(Fields& fields) {
  fields.number("force.filter_time_constant_s", low_pass_s, not_negative(),
                "time constant of the force sensor's low-pass; 0: none [s]");
}

void ForceSensorSettings::bind_noise(Fields& fields) {
  fields.number("sensor.force_noise_N", noise_N, not_negative(),
                "standard deviation of white noise on each force sample [N]");
}

void ForceSensorSettings::bind(Fields& fields) {
  fields.optional_number(
      "sensor.force_tool_mass_kg", tool_mass_kg, not_negative(),
      "mass before the force sensor beside the tip's own: the sensor reads its inertia [kg]");
  fields.optional_number("sensor.force_resonance_Hz", resonance_Hz, not_negative(),
                         "natural frequency of the sensor's body; 0: rigid [Hz]");
  fields.optional_number("sensor.force_damping_ratio", damping_ratio, between(0.0, 0.99),
                         "damping ratio of the sensor's body");
  fields.only_where({"sensor.force_damping_ratio"}, "sensor.force_resonance_Hz is not 0",
                    [this] { return resonance_Hz != 0.0; });
  fields.optional_number("sensor.force_bias_N", electronics.bias, any(),
                         "constant error of the sensor [N]");
  fields.optional_number("sensor.force_drift_N_sqrt_s", electronics.drift_per_sqrt_s,
                         not_negative(),
                         "drift, a random walk: its standard deviation after 1 s [N/s^0.5]");
  fields.optional_number("sensor.force_range_N", electronics.range, not_negative(),
                         "range: larger forces of either sign are clipped; 0: no limit [N]");
  fields.optional_number("sensor.force_quantum_N", electronics.quantum, not_negative(),
                         "one step of the converter; 0: no quantisation [N]");
  fields.optional_number("sensor.force_period_s", electronics.period_s, not_negative(),
                         "the sensor's own sampling period; 0: physics.timestep_s [s]");
  fields.optional_number("sensor.force_delay_s", electronics.delay_s, not_negative(),
                         "delay of the sensor's samples [s]");
  fields.optional_number(
      "sensor.force_weighed_kg", weighed_kg, between(SensorChannel::kAllBeyond, 1e3),
      "mass beyond the sensor whose weight is taken off each sample, as the sensor is turned; "
      "negative: all that the model has there [kg]");
  fields.optional_number(
      "sensor.force_tare_at_s", tare_at_s, between(SensorChannel::kNever, 1e9),
      "time whose value, before noise, is taken off all samples from then on; -1: none [s]");
}

void ForceSensorSettings::check(const Config& config, double timestep_s) const {
  check_multiple(config, "sensor.force_period_s", electronics.period_s, timestep_s,
                 "physics.timestep_s");
  check_multiple(config, "sensor.force_delay_s", electronics.delay_s, timestep_s,
                 "physics.timestep_s");
}

void ForceSensorSettings::add_channels(SensingSetup& setup, SensorChannel raw) const {
  raw.name = "force_raw";
  raw.body = {2.0 * std::numbers::pi * resonance_Hz, damping_ratio};
  raw.electronics = electronics;
  raw.weighed_kg = weighed_kg;
  raw.tare_at_s = tare_at_s;
  raw.noise_std = noise_N;
  SensorChannel filtered = raw;
  filtered.name = "force";
  filtered.low_pass_s = low_pass_s;
  setup.channels.insert(setup.channels.end(), {std::move(filtered), std::move(raw)});
}

}  // namespace breakwater
