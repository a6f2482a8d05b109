// Scenarios that run on an identified axis.
#pragma once

#include <string>
#include <vector>

#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

/// The identified parameters of a rotating axis for a scenario, in SI units.
struct IdentifiedPlant {
  double inertia = 0.0;
  double viscous_friction = 0.0;
  double coulomb_friction = 0.0;
  double breakaway_friction = 0.0;  ///< friction at rest beyond the Coulomb friction
  double stribeck_speed = 0.0;      ///< v_s, if there is such friction
  double delay_s = 0.0;
  double period_s = 0.0;
  double quantum = 0.0;  ///< one count; 0: not quantised
  EncoderRounding rounding = EncoderRounding::nearest;
  double noise_std = 0.0;
  double largest_torque = 0.0;  ///< the largest torque of the records
};

/// A scenario that takes an identified plant.
struct IdentifiedScenarioKind {
  static constexpr const char* kWhat = "scenario of an identified axis";

  std::string name;       ///< name of the scenario
  std::string case_name;  ///< the case that identified.toml has
  /// The values of its keys, "key=value". Controller and disturbance fit the size of the plant.
  std::vector<std::string> (*sets)(const IdentifiedPlant& plant);
  // The keys of the parameters that a study may draw.
  std::string inertia_key;
  std::string viscous_key;
  std::string coulomb_key;
};

}  // namespace breakwater
