// Checks whether the sensor's error explains an estimator's innovations.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <breakwater/record/recording.h>

namespace breakwater {

/// Compares innovations e with R = Δ²/12 + σ², the variance of the sensor's error, plus that of the
/// error of the instant. An encoder that truncates has Δ²/3. Estimators' variances have no common
/// unit.
///
/// With a correct model and a small error of the estimator, e²/R is chi-square distributed. A value
/// above 15.1, the 99.99 % quantile, is unexplained. It counts as 15.1 in the mean, so that a step
/// of the disturbance does not dominate a record. Rounding alone gives no such value: the
/// prediction and the code then differ by at most a count, so e² ≤ 12 R.
class InnovationStatistics {
 public:
  /// `sensor_std` is the root of SensorError::variance(); 0: unknown.
  explicit InnovationStatistics(double sensor_std) : variance_(sensor_std * sensor_std) {}

  /// `instant_error` is the speed of the output times the standard deviation of the instant.
  void add(double innovation, double instant_error);
  /// Separates the next innovation from the last one.
  void interrupt() { has_last_ = false; }

  std::optional<double> rms() const;
  /// The mean of e²/R: 1 if the sensor's error explains the innovations.
  std::optional<double> normalised_square() const;
  /// The share of unexplained innovations.
  std::optional<double> unexplained_share() const;
  /// The correlation of successive innovations: 0 within ±2/√N for white noise.
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

/// "the model does not explain the data: ..." if a finished estimation shows this; nothing if the
/// model explains them or the sensor's error is unknown.
std::optional<std::string> doubt_of(const Recording& recording);

}  // namespace breakwater
