// Encoder quantisation.
#pragma once

#include <cmath>
#include <numbers>

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

/// An encoder's counts for one revolution of what is measured (b_reso of Eq. 4.23).
struct EncoderCounts {
  double bits = 0.0;            ///< n: 2ⁿ pulses per revolution of the encoder's own shaft
  double multiplication = 1.0;  ///< edges counted per pulse
  double gear_ratio = 1.0;      ///< revolutions of the encoder's shaft per revolution

  double pulses_per_revolution() const { return std::exp2(bits) * multiplication * gear_ratio; }
  /// Q_max = 2π/b_reso (Eq. 4.23).
  double quantum_rad() const { return 2.0 * std::numbers::pi / pulses_per_revolution(); }
};

}  // namespace breakwater
