// The chain of a force sensor, from the tool before it to its samples.
#pragma once

#include <string>

#include <breakwater/config/fields.h>
#include <breakwater/sim/sensing.h>

namespace breakwater {

/// Keys sensor.force_…, each of which is off at 0.
struct ForceSensorSettings {
  double tool_mass_kg = 0.0;  ///< before the sensor: it reads what this mass' inertia takes
  double resonance_Hz = 0.0;
  double damping_ratio = 0.0;
  SensorElectronics electronics;

  void bind(Fields& fields);
  /// Throws std::invalid_argument, blaming a key, if a time is no multiple of the timestep.
  void check(const Config& config, double timestep_s) const;
  void apply(SensorChannel& channel) const;
  bool has_body() const { return resonance_Hz > 0.0; }
};

}  // namespace breakwater
