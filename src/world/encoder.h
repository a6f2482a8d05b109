// Encoder quantisation.
#pragma once

#include <cmath>
#include <numbers>

#include <breakwater/math/functions.h>
#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

/// The position that an encoder calls 0; [x] is x in whole counts, as the rounding says.
enum class EncoderOrigin {
  counted,    ///< where it starts: it counts edges from there, y = Δ·([(q + φ)/Δ] − [φ/Δ])
  calibrated  ///< q = 0, known to a fraction of a count: y = Δ·[(q + φ)/Δ] − φ
};

/// Counted, it reads 0 at q = 0 wherever between two edges that lies, as an incremental encoder
/// does. Calibrated, φ decides whether q = 0 lies on a count or between two, and a loop that holds
/// q at 0 between two counts hunts for ever. One that truncates reads 0 over two counts' width,
/// around q = −φ.
struct Encoder {
  double quantum = 0.0;  ///< Δ, one count, in the angle's unit; 0 means no quantisation
  double phase = 0.0;    ///< φ, how far q = 0 lies from the middle between two edges
  EncoderOrigin origin = EncoderOrigin::counted;
  EncoderRounding rounding = EncoderRounding::nearest;

  double measure(double q) const {
    if (quantum == 0.0) return q;
    const double code = counts((q + phase) / quantum);
    if (origin == EncoderOrigin::calibrated) return quantum * code - phase;
    return quantum * (code - counts(phase / quantum));
  }

 private:
  double counts(double value) const {
    return rounding == EncoderRounding::truncate ? std::trunc(value) : std::round(value);
  }
};

/// An encoder's counts for one revolution of what is measured (b_reso of Eq. 4.23).
struct EncoderCounts {
  double bits = 0.0;            ///< n: 2ⁿ pulses per revolution of the encoder's own shaft
  double multiplication = 1.0;  ///< edges counted per pulse
  double gear_ratio = 1.0;      ///< revolutions of the encoder's shaft per revolution

  double counts_per_revolution() const {
    return math::pow(2.0, bits) * multiplication * gear_ratio;
  }
  /// Q_max = 2π/b_reso (Eq. 4.23).
  double quantum_rad() const { return 2.0 * std::numbers::pi / counts_per_revolution(); }
};

}  // namespace breakwater
