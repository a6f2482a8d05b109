// How the samples of a record follow each other, for an estimator that follows them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// In how many pieces an interval is predicted: one a period, one at least, a thousand at most.
inline double pieces_of(double length_s, double period_s) {
  return std::clamp(std::round(length_s / period_s), 1.0, 1000.0);
}

/// The rows of a record.
struct RecordRows {
  std::span<const double> times_s;  ///< rising
  /// u of each row, one after the other: `width` values each. They act after their row, until the
  /// next one, or acted before it.
  std::span<const double> inputs;
  Eigen::Index width = 1;
  bool inputs_act_before = false;
  double period_s = 0.0;       ///< T_s
  double gap_periods = 1.5;    ///< in a longer interval rows are missing
  double instant_std_s = 0.0;  ///< how well the times are known
  double output_std = 0.0;     ///< of the output's own error; 0: R is its variance
};

/// The interval before each row, and the input that was held over it.
///
/// An interval that is a period but for the rounding of the times is one. Where n − 1 rows are
/// missing, the inputs between are taken to lie on the line from the last one to the next: their
/// mean is what was held. How far off such a mean is, the rest of the record says: the root mean
/// square of it over all places with n rows.
class RecordIntervals {
 public:
  /// The rows outlive it.
  explicit RecordIntervals(const RecordRows& rows);

  /// Whether there is nothing to follow: each interval is a period, each instant known.
  bool is_regular() const { return is_regular_; }

  /// Moves on to row k > 0, from the last one. Allocates nothing but for a gap of a new length.
  void move_to(std::size_t k);
  const SampleInterval& interval() const { return interval_; }
  const Eigen::VectorXd& held_input() const { return held_; }

 private:
  Eigen::Map<const Eigen::VectorXd> input(std::size_t k) const {
    return {rows_.inputs.data() + static_cast<Eigen::Index>(k) * rows_.width, rows_.width};
  }
  bool is_period(std::size_t k) const;
  double missing_std(std::size_t n);

  RecordRows rows_;
  bool is_regular_ = true;
  SampleInterval interval_;
  Eigen::VectorXd held_;
  std::map<std::size_t, double> missing_std_;  // by n
};

}  // namespace breakwater
