// A sine of the position: ripple of a motor, error of an encoder.
#pragma once

#include <breakwater/math/functions.h>

namespace breakwater {

/// a sin(n q), or 0 if a = 0.
struct PositionSine {
  double amplitude = 0.0;   ///< a
  double wavenumber = 1.0;  ///< n [rad per unit of position]: periods per turn of an angle

  double value(double position) const {
    return amplitude == 0.0 ? 0.0 : amplitude * math::sin(wavenumber * position);
  }
};

}  // namespace breakwater
