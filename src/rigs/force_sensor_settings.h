// The chain of a force sensor, from the tool before it to its samples.
#pragma once

#include <string>

#include <breakwater/config/fields.h>
#include <breakwater/sim/sensing.h>

namespace breakwater {

/// Keys sensor.force_… and force.filter_time_constant_s, each of which is off at 0.
struct ForceSensorSettings {
  double low_pass_s = 0.0;    ///< time constant
  double noise_N = 0.0;       ///< standard deviation at each sample
  double tool_mass_kg = 0.0;  ///< before the sensor: it reads what this mass' inertia takes
  double resonance_Hz = 0.0;
  double damping_ratio = 0.0;
  SensorElectronics electronics;
  double weighed_kg = 0.0;
  double tare_at_s = SensorChannel::kNever;

  void bind_filter(Fields& fields);
  void bind_noise(Fields& fields);
  /// All other keys.
  void bind(Fields& fields);
  /// Throws std::invalid_argument, blaming a key, if a time is no multiple of the timestep.
  void check(const Config& config, double timestep_s) const;
  bool has_body() const { return resonance_Hz > 0.0; }
  /// Adds the channels "force", behind the low-pass, and "force_raw", before it, of a channel that
  /// says what is measured.
  void add_channels(SensingSetup& setup, SensorChannel raw) const;
};

}  // namespace breakwater
