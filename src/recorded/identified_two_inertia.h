// A scenario that runs on an identified motor and load.
#pragma once

#include <string>
#include <vector>

#include <breakwater/plants/motor_and_load.h>
#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

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
