// Encoder quantisation.
#pragma once

#include <cmath>
#include <numbers>

namespace breakwater {

/// An incremental encoder: it counts the edges that it passes from where it starts,
///     y = Δ·(round((q + φ)/Δ) − round(φ/Δ)),
/// so that it reads 0 at q = 0 wherever between two edges that lies. (Subtracting φ instead of whole
/// counts would give it a knowledge of φ that it cannot have.)
struct Encoder {
  double quantum = 0.0;  ///< Δ, one count, in the angle's unit; 0 means no quantisation
  double phase = 0.0;    ///< φ, how far q = 0 lies from the middle between two edges

  double measure(double q) const {
    if (quantum == 0.0) return q;
    return quantum * (std::round((q + phase) / quantum) - std::round(phase / quantum));
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
