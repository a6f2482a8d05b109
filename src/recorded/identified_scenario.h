// Scenarios that run on an identified axis.
#pragma once

#include <string>
#include <vector>

#include <breakwater/plants/motor_and_load.h>
#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

/// The identified parameters of a rotating axis for a scenario, in SI units.
struct IdentifiedPlant {
  double inertia = 0.0;
  double viscous_friction = 0.0;
  double coulomb_friction = 0.0;
  double breakaway_friction = 0.0;  ///< friction at rest beyond the Coulomb friction
  double stribeck_speed = 0.0;      ///< v_s; 0: no breakaway friction
  double offset_torque = 0.0;
  double delay_s = 0.0;  ///< from the command to the torque
  double period_s = 0.0;
  double quantum = 0.0;  ///< one count; 0: not quantised
  double phase = 0.0;    ///< the encoder's
  EncoderRounding rounding = EncoderRounding::nearest;
  double noise_std = 0.0;
  double largest_torque = 0.0;  ///< the largest torque of the records
};

/// A scenario that takes an identified plant.
struct IdentifiedScenarioKind {
  static constexpr const char* kWhat = "scenario of an identified axis";

  std::string name;       ///< name of the scenario
  std::string case_name;  ///< the case that identified.toml has
  /// The keys of the true plant, "key=value". A study draws their values, in the same order for
  /// each plant.
  std::vector<std::string> (*plant_sets)(const IdentifiedPlant& plant);
  /// The other keys. Nominal plant, controller and disturbance fit the size of the plant.
  std::vector<std::string> (*other_sets)(const IdentifiedPlant& plant);
  /// The lines of a tuning that name its algorithm, keys and objectives.
  std::string (*tuning)(const IdentifiedPlant& plant);
};

/// The identified plant, in SI units. `linear` has the ratio 1.
struct IdentifiedTwoInertia {
  TwoInertia linear;
  double backlash = 0.0;
  double motor_coulomb = 0.0;
  double load_coulomb = 0.0;
  double delay_s = 0.0;
  double period_s = 0.0;
  double quantum = 0.0;  ///< one count; 0: not quantised
  EncoderRounding rounding = EncoderRounding::nearest;
  double noise_std = 0.0;
  Side measured = Side::motor;
};

struct IdentifiedTwoInertiaKind {
  static constexpr const char* kWhat = "scenario of an identified motor and load";

  std::string name;       ///< name of the scenario
  std::string case_name;  ///< the case that identified.toml has
  /// The values of its keys, "key=value". Nominal plant and controller fit the plant.
  std::vector<std::string> (*sets)(const IdentifiedTwoInertia& plant);
};

}  // namespace breakwater
