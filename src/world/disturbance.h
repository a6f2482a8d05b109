// A disturbance as a function of time: step, ramp or sine.
#pragma once

namespace breakwater {

enum class DisturbanceKind { none, step, ramp, sine };

/// 0 before `start_s`, and from then on
///     step: amplitude;  ramp: amplitude·(t − start);  sine: amplitude·sin(ω (t − start)).
/// A ramp's amplitude is its slope, in the disturbance's unit per second.
struct Disturbance {
  DisturbanceKind kind = DisturbanceKind::none;
  double amplitude = 0.0;
  double frequency_rad_s = 0.0;  ///< ω, of a sine
  double start_s = 0.0;

  double value(double time_s) const;
  /// Its derivative, but for the jump of a step.
  double rate(double time_s) const;
};

}  // namespace breakwater
