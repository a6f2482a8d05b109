// What is known of a sensor's error.
#pragma once

#include <Eigen/Core>

#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

/// Of each output, in its unit.
struct SensorError {
  Eigen::VectorXd quantum;    ///< Δ, what one count of an encoder is worth; 0: not quantised
  Eigen::VectorXd noise_std;  ///< σ, of white noise
  EncoderRounding rounding = EncoderRounding::nearest;

  /// E[(y − q)²] of each output: Δ²/12 + σ², or Δ²/3 + σ² of an encoder that truncates.
  Eigen::VectorXd variance() const;
};

/// The positions of a code y: they lie between y + lower and y + upper.
struct CodeRange {
  double lower;
  double upper;

  double width() const { return upper - lower; }
  double middle() const { return 0.5 * (lower + upper); }  ///< from y
};

/// An encoder that rounds gives y ± Δ/2. One that truncates gives the count beyond y, as seen from
/// 0, and the counts on both sides of 0 where y is 0. Noise that is added to the code does not hide
/// which code it was as long as it is small against Δ.
CodeRange code_range(double y, double quantum, EncoderRounding rounding);

/// Throws std::invalid_argument unless both have one finite entry ≥ 0 for each of p outputs.
void check(const SensorError& error, Eigen::Index outputs);

}  // namespace breakwater
