// Encoder quantisation.
#pragma once

#include <cmath>
#include <numbers>

#include <breakwater/math/functions.h>
#include <breakwater/signals/encoder_rounding.h>
#include <breakwater/world/position_sine.h>

namespace breakwater {

/// The origin of an encoder. [x] is x in whole counts, rounded or truncated.
enum class EncoderOrigin {
  counted,    ///< the start: it counts edges from there, y = Δ·([(q + φ)/Δ] − [φ/Δ])
  calibrated  ///< q = 0, known more exactly than a count: y = Δ·[(q + φ)/Δ] − φ
};

/// An encoder. Counted, it reads 0 at q = 0 for every phase, like an incremental encoder.
/// Calibrated, φ determines whether q = 0 is on a count or between two. A loop that holds q at 0
/// between two counts has a limit cycle. One that truncates reads 0 over two counts around −φ.
struct Encoder {
  double quantum = 0.0;  ///< Δ, one count, in the angle's unit; 0: no quantisation
  double phase = 0.0;    ///< φ, distance of q = 0 from the middle between two edges
  EncoderOrigin origin = EncoderOrigin::counted;
  EncoderRounding rounding = EncoderRounding::nearest;
  PositionSine eccentricity;   ///< error of a scale that is not centred on its shaft
  PositionSine interpolation;  ///< error between two lines of the scale

  /// The scale's error at the true position q.
  double error(double q) const { return eccentricity.value(q) + interpolation.value(q); }

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

/// Counts of an encoder for one revolution of the measured shaft (b_reso of Eq. 4.23).
struct EncoderCounts {
  int bits = 0;                 ///< n: 2ⁿ pulses per revolution of the encoder's shaft
  double multiplication = 1.0;  ///< edges counted per pulse
  double gear_ratio = 1.0;      ///< revolutions of the encoder's shaft per measured revolution

  double counts_per_revolution() const {
    return math::pow(2.0, bits) * multiplication * gear_ratio;
  }
  /// Q_max = 2π/b_reso (Eq. 4.23).
  double quantum_rad() const { return 2.0 * std::numbers::pi / counts_per_revolution(); }
};

}  // namespace breakwater
