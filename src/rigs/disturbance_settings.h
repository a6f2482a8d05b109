// The keys of a disturbance.
#pragma once

#include <string>

#include <breakwater/config/fields.h>
#include <breakwater/world/disturbance.h>

namespace breakwater {

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

}  // namespace breakwater
