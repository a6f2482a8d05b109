// Known properties of a sensor's error.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include <breakwater/math/refuse_unless.h>
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
  Eigen::VectorXd variance() const {
    const double of_a_uniform_error = rounding == EncoderRounding::truncate ? 3.0 : 12.0;
    return quantum.cwiseAbs2() / of_a_uniform_error + noise_std.cwiseAbs2();
  }
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
inline CodeRange code_range(double y, double quantum, EncoderRounding rounding) {
  const double half = 0.5 * quantum;
  if (rounding == EncoderRounding::nearest) return {-half, half};
  if (std::abs(y) < half) return {-quantum, quantum};
  return y > 0.0 ? CodeRange{0.0, quantum} : CodeRange{-quantum, 0.0};
}

/// Throws std::invalid_argument unless quantum and noise_std have one finite entry ≥ 0 per output.
inline void check(const SensorError& error, Eigen::Index outputs) {
  const auto fits = [outputs](const Eigen::VectorXd& values) {
    return values.size() == outputs && values.allFinite() && values.minCoeff() >= 0.0;
  };
  refuse_unless(fits(error.quantum) && fits(error.noise_std),
                "sensor error: needs a quantum and a standard deviation >= 0 for each output");
}

}  // namespace breakwater
