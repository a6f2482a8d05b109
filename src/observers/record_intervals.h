// The intervals between the samples of a record, for an estimator.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

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
  explicit RecordIntervals(const RecordRows& rows)
      : rows_(rows), held_(Eigen::VectorXd::Zero(rows.width)) {
    interval_.instant_std_s = rows.instant_std_s;
    interval_.output_std = rows.output_std;
    is_regular_ = rows.instant_std_s == 0.0;
    for (std::size_t k = 1; k < rows.times_s.size(); ++k) is_regular_ = is_regular_ && is_period(k);
  }

  /// Whether each interval is T_s and each time is exact.
  bool is_regular() const { return is_regular_; }

  /// Moves to row k > 0 from the row before. Allocates only for a gap of a new length.
  void move_to(std::size_t k) {
    const bool acts_before = rows_.inputs_act_before;
    const double length_s = rows_.times_s[k] - rows_.times_s[k - 1];
    held_ = input(acts_before ? k : k - 1);
    interval_.length_s = is_period(k) ? 0.0 : length_s;
    interval_.input_std = 0.0;
    if (!(length_s > rows_.gap_periods * rows_.period_s)) return;
    const double n = std::max(std::round(length_s / rows_.period_s), 1.0);
    const double share = (n - 1.0) / (2.0 * n);
    held_ += share * (input(acts_before ? k - 1 : k) - held_);
    interval_.input_std = missing_std(
        static_cast<std::size_t>(std::min(n, static_cast<double>(rows_.times_s.size()))));
  }
  const SampleInterval& interval() const { return interval_; }
  const Eigen::VectorXd& held_input() const { return held_; }

 private:
  Eigen::Map<const Eigen::VectorXd> input(std::size_t k) const {
    return {rows_.inputs.data() + static_cast<Eigen::Index>(k) * rows_.width, rows_.width};
  }
  // Allows for the rounding of both times and of the period.
  bool is_period(std::size_t k) const {
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
    constexpr double kShare = 1e-9;
    const double last_s = rows_.times_s[k - 1];
    const double now_s = rows_.times_s[k];
    const double rounding_s = kEpsilon * (std::abs(last_s) + std::abs(now_s));
    return std::abs(now_s - last_s - rows_.period_s) <= rounding_s + kShare * rows_.period_s;
  }

  double missing_std(std::size_t n) {
    const auto [found, is_new] = missing_std_.try_emplace(n, 0.0);
    if (!is_new) return found->second;
    const std::size_t rows = rows_.times_s.size();
    const double share = (static_cast<double>(n) - 1.0) / (2.0 * static_cast<double>(n));
    for (Eigen::Index column = 0; column < rows_.width; ++column) {
      const auto u = [&](std::size_t k) { return input(k)(column); };
      double sum = 0.0;  // sum of n inputs from row k on
      double squares = 0.0;
      if (n < rows) {
        for (std::size_t k = 0; k < n; ++k) sum += u(k);
        for (std::size_t k = 0; k + n < rows; ++k) {
          const double off = sum / static_cast<double>(n) - u(k) - share * (u(k + n) - u(k));
          squares += off * off / static_cast<double>(rows - n);
          sum += u(k + n) - u(k);
        }
      } else {  // the record is too short: the size of the inputs is the only bound
        for (std::size_t k = 0; k < rows; ++k) squares += u(k) * u(k) / static_cast<double>(rows);
      }
      found->second = std::max(found->second, std::sqrt(squares));
    }
    return found->second;
  }

  RecordRows rows_;
  bool is_regular_ = true;
  SampleInterval interval_;
  Eigen::VectorXd held_;
  std::map<std::size_t, double> missing_std_;  // key: n
};

}  // namespace breakwater
