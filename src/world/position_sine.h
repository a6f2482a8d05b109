// A sine of the position: ripple of a motor, error of an encoder.
#pragma once

#include <numbers>

#include <breakwater/math/functions.h>

namespace breakwater {

/// a sin(2π n q/L), or 0 if a = 0.
struct PositionSine {
  double amplitude = 0.0;                  ///< a
  double periods = 1.0;                    ///< n: in the length L
  double length = 2.0 * std::numbers::pi;  ///< L: a turn, or 1 m

  double value(double position) const {
    if (amplitude == 0.0) return 0.0;
    return amplitude * math::sin(2.0 * std::numbers::pi / length * periods * position);
  }
};

}  // namespace breakwater
