// Parts of a plant besides its axes: disturbances, forces on bodies, the tip with its force sensor.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/config/fields.h>
#include <breakwater/control/reference.h>
#include <breakwater/rigs/contact_settings.h>
#include <breakwater/sim/sensing.h>
#include <breakwater/world/disturbance.h>

namespace breakwater {

/// Keys sensor.force_… and force.filter_time_constant_s, each of which is off at 0.
struct ForceSensorSettings {
  double low_pass_s = 0.0;    ///< time constant
  double tool_mass_kg = 0.0;  ///< before the sensor: it reads what this mass' inertia takes
  double resonance_Hz = 0.0;
  SensorChannel raw;  ///< the rest of the channel before the low-pass

  void bind_filter(Fields& fields);
  void bind_noise(Fields& fields);
  /// All other keys.
  void bind(Fields& fields);
  /// Throws std::invalid_argument, blaming a key, if a time is no multiple of the timestep.
  void check(const Config& config, double timestep_s) const;
  /// The channels "force", behind the low-pass, and "force_raw", before it, without what they read.
  std::array<SensorChannel, 2> channels() const;
};

/// A disturbance by the keys disturbance.…
struct DisturbanceSettings {
  Disturbance shape;
  std::string file;    ///< table of the kind csv
  double end_s = 0.0;  ///< 0: the end of the run

  /// `suffix` and `unit` are those of the amplitude: "Nm", "N m".
  void bind(Fields& fields, const std::string& suffix, const std::string& unit);

  /// Reads the table of the kind csv, and checks the end. Throws std::invalid_argument `ORIGIN:
  /// KEY: reason`.
  void load(const Config& config);

  /// The disturbance, where noise has the run's seed and the stream `channel`.
  Disturbance make(std::uint64_t seed, const std::string& channel) const;
};

/// A force on a body: keys push.NAME.….
struct PushSettings {
  std::string name;
  std::string body;
  std::vector<double> along;  ///< direction in the world, of any length
  DisturbanceSettings disturbance;

  std::string prefix() const { return "push." + name + "."; }
  void bind(Fields& fields);
};

/// The force sensor of the tip and the reference of its force: keys tip.…, sensor.force_…, force.….
struct TipSettings {
  static constexpr const char* kNone = "none";

  std::string contact = kNone;  ///< its force is the true one, if no `touch` is
  std::string touch;            ///< <touch> of the model with the force of the engine's contact
  std::string sensor = kNone;   ///< kNone: the force of the contact is measured itself
  int component = 0;
  ForceSensorSettings chain;
  Reference reference;  ///< 0 until it begins

  void bind(Fields& fields);
  /// Puts the tool's mass before the sensor.
  void add_tool(Model& model) const;
};

}  // namespace breakwater
