// Whether an estimator's innovations are what its sensor's error explains.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <breakwater/record/recording.h>

namespace breakwater {

/// Innovations e against the variance of the sensor's error alone, R = Δ²/12 + σ² (Δ²/3
/// where the encoder truncates) and what the instant's error makes of it: the estimators' own
/// variances have no common unit.
///
/// e²/R is chi-square distributed where the model is right and the estimator's own error small. One
/// beyond what all but one of 10⁴ of such are, e² > 15.1 R, is not explained, and counts as 15.1 in
/// the mean: a step of the disturbance shall not decide over a record. Rounding alone never gives
/// one, since prediction and code are then at most a count apart: e² ≤ 12 R.
class InnovationStatistics {
 public:
  /// `sensor_std`: the root of SensorError::variance(); 0: nothing is known of it.
  explicit InnovationStatistics(double sensor_std) : variance_(sensor_std * sensor_std) {}

  /// `instant_error`: the output's speed times the standard deviation of the instant.
  void add(double innovation, double instant_error);
  /// The next one does not follow the last one.
  void interrupt() { has_last_ = false; }

  std::optional<double> rms() const;
  /// The mean of e²/R: 1 where the sensor's error explains the innovations.
  std::optional<double> normalised_square() const;
  /// How many are not explained, of all.
  std::optional<double> unexplained_share() const;
  /// From one to the next: 0 of white noise, within ±2/√N.
  std::optional<double> correlation() const;

 private:
  double variance_;
  std::int64_t count_ = 0;
  std::int64_t unexplained_ = 0;
  double squares_ = 0.0;
  double normalised_ = 0.0;
  double products_ = 0.0;
  double last_ = 0.0;
  bool has_last_ = false;
};

/// "the model does not explain the data: ...", if a finished estimation shows it; nothing if the
/// model does, or nothing is known.
std::optional<std::string> doubt_of(const Recording& recording);

}  // namespace breakwater
