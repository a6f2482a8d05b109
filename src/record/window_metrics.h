// Metrics, computed sample by sample.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace breakwater {

/// An interval of time, both ends included.
struct TimeWindow {
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();

  bool contains(double time_s) const { return time_s >= from_s && time_s <= to_s; }

  /// The window itself if a run from 0 to `end_s` covers it. Otherwise it is empty: a metric of a
  /// part of the window would be misleading. An open end is the end of the run.
  TimeWindow within(double end_s) const {
    constexpr double kOpen = std::numeric_limits<double>::infinity();
    if (from_s >= 0.0 && (to_s <= end_s || to_s == kOpen)) return *this;
    return {kOpen, -kOpen};
  }

  /// The same, extended to the end of a longer run: a settled value must stay settled.
  TimeWindow within_and_on(double end_s) const {
    TimeWindow window = within(end_s);
    if (window.to_s == to_s) window.to_s = std::numeric_limits<double>::infinity();
    return window;
  }
};

/// Mean and variance of the added values, by Welford's recursion.
class RunningVariance {
 public:
  void add(double value) {
    ++count_;
    const double step = value - mean_;
    mean_ += step / static_cast<double>(count_);
    squared_deviation_ += step * (value - mean_);
  }

  std::int64_t count() const { return count_; }
  double mean() const { return mean_; }
  /// The sample standard deviation; nothing for less than two values.
  std::optional<double> standard_deviation() const {
    if (count_ < 2) return std::nullopt;
    return std::sqrt(squared_deviation_ / static_cast<double>(count_ - 1));
  }

 private:
  std::int64_t count_ = 0;
  double mean_ = 0.0;
  double squared_deviation_ = 0.0;
};

/// Mean, spread, root mean square and extremes of a window; nothing if it is empty.
class WindowStatistics {
 public:
  explicit WindowStatistics(const TimeWindow& window) : window_(window) {}

  void add(double time_s, double value) {
    if (!window_.contains(time_s)) return;
    sum_ += value;
    sum_of_squares_ += value * value;
    variance_.add(value);
    largest_ = std::max(largest_, value);
    smallest_ = std::min(smallest_, value);
  }

  std::optional<double> mean() const {
    return if_any(sum_ / static_cast<double>(variance_.count()));
  }
  /// The mean by Welford's recursion.
  std::optional<double> running_mean() const { return if_any(variance_.mean()); }
  std::optional<double> rms() const {
    return if_any(std::sqrt(sum_of_squares_ / static_cast<double>(variance_.count())));
  }
  std::optional<double> largest() const { return if_any(largest_); }
  std::optional<double> smallest() const { return if_any(smallest_); }
  /// The largest |value|.
  std::optional<double> peak() const { return if_any(std::max(largest_, -smallest_)); }
  /// The sample standard deviation; nothing for less than two values.
  std::optional<double> standard_deviation() const { return variance_.standard_deviation(); }
  /// The largest |value − mean|.
  std::optional<double> largest_deviation() const {
    const double middle = sum_ / static_cast<double>(variance_.count());
    return if_any(std::max(largest_ - middle, middle - smallest_));
  }

 private:
  std::optional<double> if_any(double value) const {
    if (variance_.count() == 0) return std::nullopt;
    return value;
  }

  TimeWindow window_;
  double sum_ = 0.0;
  double sum_of_squares_ = 0.0;
  RunningVariance variance_;
  double largest_ = -std::numeric_limits<double>::infinity();
  double smallest_ = std::numeric_limits<double>::infinity();
};

/// The time from the beginning of a window until an error stays within ±band to its end.
class SettlingTime {
 public:
  SettlingTime(const TimeWindow& window, double band) : window_(window), band_(band) {}

  void add(double time_s, double error) {
    if (!window_.contains(time_s)) return;
    ++count_;
    const bool is_inside = std::abs(error) <= band_;
    if (is_inside && !settled_) settled_at_s_ = time_s;
    settled_ = is_inside;
  }

  /// Nothing if the error ends outside the band, or the window has no values.
  std::optional<double> value() const {
    if (count_ == 0 || !settled_) return std::nullopt;
    return settled_at_s_ - window_.from_s;
  }

 private:
  TimeWindow window_;
  double band_;
  std::int64_t count_ = 0;
  bool settled_ = false;
  double settled_at_s_ = 0.0;
};

/// The time until |value| first reaches a level; nothing if it never does, or the level is 0.
class ReachTime {
 public:
  ReachTime(double from_s, double level) : from_s_(from_s), level_(level) {}

  void add(double time_s, double value) {
    if (value_ || level_ == 0.0 || time_s < from_s_ || std::abs(value) < level_) return;
    value_ = time_s - from_s_;
  }

  std::optional<double> value() const { return value_; }

 private:
  double from_s_;
  double level_;
  std::optional<double> value_;
};

/// The number of times that a value turns back by more than `band` from its farthest point. The
/// first motion is not a turn.
class ReversalCount {
 public:
  explicit ReversalCount(double band) : band_(band) {}

  void add(double value) {
    if (way_ == 0.0) {
      smallest_ = std::min(smallest_, value);
      largest_ = std::max(largest_, value);
      if (value > smallest_ + band_) set_out(1.0, value);
      if (value < largest_ - band_) set_out(-1.0, value);
    } else if (way_ * (value - farthest_) > 0.0) {
      farthest_ = value;
    } else if (way_ * (farthest_ - value) > band_) {
      ++count_;
      set_out(-way_, value);
    }
  }

  int value() const { return count_; }

 private:
  void set_out(double way, double from) {
    way_ = way;
    farthest_ = from;
  }

  double band_;
  int count_ = 0;
  double way_ = 0.0;  // direction: 1, -1, or 0 before the first motion
  double farthest_ = 0.0;
  double smallest_ = std::numeric_limits<double>::infinity();
  double largest_ = -std::numeric_limits<double>::infinity();
};

}  // namespace breakwater
