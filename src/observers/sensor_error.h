// Known properties of a sensor's error.
#pragma once

#include <Eigen/Core>

#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

/// The error of the arithmetic in place of the sensor's: the smallest variance of an output.
inline constexpr double kSmallestVariance = 1e-26;

/// One entry for each output, in its unit.
struct SensorError {
  Eigen::VectorXd quantum;    ///< encoder resolution Δ; 0: not quantised
  Eigen::VectorXd noise_std;  ///< standard deviation σ of white noise
  EncoderRounding rounding = EncoderRounding::nearest;

  /// E[(y − q)²] of each output: Δ²/12 + σ², or Δ²/3 + σ² for an encoder that truncates.
  Eigen::VectorXd variance() const;
};

/// The positions with the code y lie between y + lower and y + upper.
struct CodeRange {
  double lower;
  double upper;

  double width() const { return upper - lower; }
  double middle() const { return 0.5 * (lower + upper); }  ///< relative to y
};

/// Rounding: y ± Δ/2. Truncation: from y to y + Δ for y > 0, from y − Δ to y for y < 0, and ±Δ for
/// y = 0. Noise added to the code does not hide the code if it is small compared with Δ.
CodeRange code_range(double y, double quantum, EncoderRounding rounding);

/// Throws std::invalid_argument unless quantum and noise_std have one finite entry ≥ 0 per output.
void check(const SensorError& error, Eigen::Index outputs);

}  // namespace breakwater
