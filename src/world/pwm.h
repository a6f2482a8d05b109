// A drive with a pulse width of finite resolution.
#pragma once

#include <cmath>

namespace breakwater {

/// Rounds a command to the nearest multiple of one step of the pulse width.
struct Pwm {
  double resolution = 0.0;  ///< one step, in the command's unit; 0: not quantised

  double output(double command) const {
    if (resolution == 0.0) return command;
    return resolution * std::round(command / resolution);
  }
};

}  // namespace breakwater
