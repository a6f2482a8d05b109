// What of all that a program needs while it runs is there, and works.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

struct HealthCheck {
  /// `missing`: what is optional is not there; all else works without. `broken`: something that is
  /// there does not work, or without it nothing does.
  enum class State { ok, missing, broken };
  std::string what;  ///< one word
  State state = State::ok;
  std::string found;    ///< one line: what it is, or why it does not work
  std::string install;  ///< a command, if one mends it
};

/// All of them, from what no run can do without to what few want. Runs each scenario for a moment,
/// draws, and calls programs of the PATH: some seconds. Call it while no other thread runs.
std::vector<HealthCheck> check_health(const Catalogue& catalogue);

}  // namespace breakwater
