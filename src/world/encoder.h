// Encoder quantisation.
#pragma once

#include <cmath>

namespace breakwater {

/// An incremental encoder that rounds to its nearest count: y = Δ·round((q + φ)/Δ) − φ.
struct Encoder {
  double quantum_rad = 0.0;  ///< Δ, one count; 0 means no quantisation
  double phase_rad = 0.0;    ///< φ, where between two counts the angle 0 lies

  double measure(double angle_rad) const {
    if (quantum_rad == 0.0) return angle_rad;
    return quantum_rad * std::round((angle_rad + phase_rad) / quantum_rad) - phase_rad;
  }
};

}  // namespace breakwater
