// Checks of the software that the program needs at run time.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

struct HealthCheck {
  /// `missing`: an optional part is absent. `broken`: a part does not work, or a necessary one is
  /// absent.
  enum class State { ok, missing, broken };
  std::string what;  ///< one word
  State state = State::ok;
  std::string found;    ///< one line: a description, or the reason of the fault
  std::string install;  ///< a command that repairs it, if any
};

/// Makes all checks, the most important first. It runs each scenario briefly, draws a picture, and
/// calls programs of the PATH. This takes some seconds. No other thread may run.
std::vector<HealthCheck> check_health(const Catalogue& catalogue);

}  // namespace breakwater
