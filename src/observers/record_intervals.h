// The intervals between the samples of a record, for an estimator.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// The number of predictions in an interval: one per period, from 1 to 1000.
inline double pieces_of(double length_s, double period_s) {
  return std::clamp(std::round(length_s / period_s), 1.0, 1000.0);
}

/// The rows of a record.
struct RecordRows {
  std::span<const double> times_s;  ///< rising
  /// u of each row, `width` values each. They act from their row to the next one, or from the row
  /// before to their row.
  std::span<const double> inputs;
  Eigen::Index width = 1;
  bool inputs_act_before = false;
  double period_s = 0.0;       ///< T_s
  double gap_periods = 1.5;    ///< a longer interval has missing rows
  double instant_std_s = 0.0;  ///< standard deviation of the times
  double output_std = 0.0;     ///< standard deviation of the output's error; 0: R is its variance
};

/// The interval before each row, and the held input during it.
///
/// An interval that differs from T_s only by rounding counts as T_s. If n − 1 rows are missing, the
/// inputs between are interpolated linearly, and the held input is their mean. The error of such a
/// mean comes from the rest of the record: its root mean square over all places with n rows.
class RecordIntervals {
 public:
  /// The data of the rows must outlive this.
  explicit RecordIntervals(const RecordRows& rows);

  /// Whether each interval is T_s and each time is exact.
  bool is_regular() const { return is_regular_; }

  /// Moves to row k > 0 from the row before. Allocates only for a gap of a new length.
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
  std::map<std::size_t, double> missing_std_;  // key: n
};

}  // namespace breakwater
