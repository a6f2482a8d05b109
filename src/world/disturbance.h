// A disturbance as a function of time: step, ramp, one or two sines, chirp, noise or a table.
#pragma once

#include <limits>
#include <optional>

#include <breakwater/math/table_function.h>
#include <breakwater/world/noise.h>

namespace breakwater {

enum class DisturbanceKind { none, step, ramp, sine, two_sines, chirp, noise, csv };

/// An offset at all times. Between `start_s` and `end_s` a shape is added, with τ = t − start and
/// amplitude A,
///     step: A;  ramp: A τ;  sine: A sin ωτ;  two sines: A sin ωτ + A₂ sin ω₂τ;
///     chirp: A sin φ(τ). φ̇ changes linearly from ω to ω_e in the time T, and then stays:
///            φ = ωτ + (ω_e − ω) τ²/(2T) up to T, then φ(T) + ω_e (τ − T);
///     noise: A times a normal number, which is drawn anew after each hold time;
///     csv: A times a table's value at τ.
/// A ramp's amplitude is its slope, in the disturbance's unit per second.
struct Disturbance {
  DisturbanceKind kind = DisturbanceKind::none;
  double amplitude = 0.0;
  double frequency_rad_s = 0.0;  ///< ω of a sine or of the first one, or start of a chirp
  double start_s = 0.0;

  double second_amplitude = 0.0;        ///< A₂
  double second_frequency_rad_s = 0.0;  ///< ω₂
  double end_frequency_rad_s = 0.0;     ///< ω_e of a chirp
  double sweep_s = 1.0;                 ///< T > 0 of a chirp
  double hold_s = 1.0;                  ///< > 0, of noise
  std::optional<Noise> noise = {};      ///< there for the kind noise
  math::TableFunction table = {};       ///< the table of a csv
  double end_s = std::numeric_limits<double>::infinity();
  double offset = 0.0;  ///< at all times

  double value(double time_s) const { return offset + shape(time_s).value; }
  /// The derivative, without the jumps of a step, of noise or at the end.
  double rate(double time_s) const { return shape(time_s).rate; }

 private:
  math::TableFunction::Value shape(double time_s) const;
};

}  // namespace breakwater
