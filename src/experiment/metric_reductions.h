// Reductions of the values of a window to one number: the kinds of [metric.NAME].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <breakwater/math/interface.h>

namespace breakwater {

/// A sum of products of numbers and names, with spaces around + - *: "first_contact + 0.2",
/// "-constraint.velocity_m_s - metrics.violation_slack".
class MetricExpression {
 public:
  /// The number of a key; nothing if there is none.
  using Numbers = std::function<std::optional<double>(const std::string& name)>;
  /// Times that the run finds out. They are infinite until they have come.
  using Events = std::map<std::string, const double*>;

  /// The events must outlive it. Throws std::invalid_argument if the form is wrong, or a name is
  /// neither a number nor an event.
  MetricExpression(const std::string& text, const Numbers& numbers, const Events& events);

  double value() const { return is_constant_ ? constant_ : sum(); }
  bool is_constant() const { return is_constant_; }

 private:
  struct Factor {
    double number;
    const double* event;  // null: the number
  };
  struct Term {
    bool is_negative;
    std::vector<Factor> factors;
  };

  double sum() const;

  std::vector<Term> terms_;
  bool is_constant_ = true;
  double constant_ = 0.0;
};

/// The times of a metric. Both ends are included, and the run must cover them. An end `before` is
/// not included, and the run may end earlier.
struct MetricWindow {
  MetricExpression from_s;
  std::optional<MetricExpression> to_s;
  std::optional<MetricExpression> before_s;
  double run_end_s;
  double rounding_s;     ///< largest rounding error of a time that is compared with `before`
  bool goes_on = false;  ///< values after its end count too

  bool contains(double time_s) const;
  /// From its start to its end, or to the end of the run.
  double length_s() const;
};

/// The values that are added at a time.
struct AddedValues {
  double time_s;
  std::span<const double> all;  ///< the values of all signals, less the subtracted ones
  double value;                 ///< the first of them
  std::optional<double> last;   ///< the value before, which may lie before the window
  bool is_first;                ///< in the window
};

/// The data of a reduction. They must outlive it.
struct ReductionSetup {
  const MetricWindow& window;
  const MetricExpression& level;
  const MetricExpression& lower;
  double period_s;     ///< time between the values
  std::size_t values;  ///< number of values that are added at a time
};

/// Mean, spread, root mean square, extremes and ends of the added values; nothing without any.
class SampleStatistics {
 public:
  void add(double value) {
    if (count_ == 0.0) first_ = value;
    last_ = value;
    sum_ += value;
    sum_of_squares_ += value * value;
    count_ += 1.0;
    const double step = value - running_mean_;
    running_mean_ += step / count_;
    squared_deviation_ += step * (value - running_mean_);
    largest_ = std::max(largest_, value);
    smallest_ = std::min(smallest_, value);
  }

  std::optional<double> sum() const { return if_any(sum_); }
  std::optional<double> mean() const { return if_any(sum_ / count_); }
  /// The mean by Welford's recursion.
  std::optional<double> running_mean() const { return if_any(running_mean_); }
  std::optional<double> rms() const { return if_any(std::sqrt(sum_of_squares_ / count_)); }
  std::optional<double> largest() const { return if_any(largest_); }
  std::optional<double> smallest() const { return if_any(smallest_); }
  /// The largest |value|.
  std::optional<double> peak() const { return if_any(std::max(largest_, -smallest_)); }
  /// The largest value, or 0 if none is above 0.
  std::optional<double> excess() const { return if_any(std::max(0.0, largest_)); }
  std::optional<double> first() const { return if_any(first_); }
  std::optional<double> last() const { return if_any(last_); }
  /// The opposite of the last value over the first one; nothing if the first one is not positive.
  std::optional<double> rebound() const {
    if (!(first_ > 0.0)) return std::nullopt;
    return -last_ / first_;
  }
  /// The sample standard deviation, by Welford's recursion; nothing for less than two values.
  std::optional<double> standard_deviation() const {
    if (count_ < 2.0) return std::nullopt;
    return std::sqrt(squared_deviation_ / (count_ - 1.0));
  }
  /// The largest |value − mean|.
  std::optional<double> largest_deviation() const {
    const double middle = sum_ / count_;
    return if_any(std::max(largest_ - middle, middle - smallest_));
  }

 private:
  std::optional<double> if_any(double value) const {
    if (count_ == 0.0) return std::nullopt;
    return value;
  }

  double count_ = 0.0;
  double first_ = 0.0;
  double last_ = 0.0;
  double sum_ = 0.0;
  double sum_of_squares_ = 0.0;
  double running_mean_ = 0.0;
  double squared_deviation_ = 0.0;
  double largest_ = -std::numeric_limits<double>::infinity();
  double smallest_ = std::numeric_limits<double>::infinity();
};

/// Reduces values to one number.
class Reduction : public Interface {
 public:
  explicit Reduction(const ReductionSetup& setup) : setup_(setup) {}

  /// Is called for each value of the window, in order. Allocates nothing.
  virtual void add(const AddedValues& added) = 0;
  /// Nothing if it does not apply. Is called after add().
  virtual std::optional<double> value() const = 0;

 protected:
  const ReductionSetup setup_;
};

/// The farthest of all values beyond 0, on the other side of their first ones.
class Beyond : public Reduction {
 public:
  explicit Beyond(const ReductionSetup& setup) : Reduction(setup), first_(setup.values) {}
  void add(const AddedValues& added) override;
  std::optional<double> value() const override { return beyond_; }

 protected:
  double first() const { return first_.front(); }

 private:
  std::vector<double> first_;
  double beyond_ = 0.0;
};

/// The unit of a sum over time, in place of a unit.
inline constexpr const char* kTimesSeconds = "times seconds";

/// A reduction and its name.
struct MetricKind {
  std::string name;
  std::string meaning;  ///< follows the name of the signal and a colon
  std::string unit;     ///< kTimesSeconds: that of the signal times s; empty: that of the signal
  std::unique_ptr<Reduction> (*make)(const ReductionSetup& setup) = nullptr;
  bool has_level = false;
  bool takes_all = false;  ///< all values of one or several signals
  bool goes_on = false;    ///< see MetricWindow
  std::string why_absent = "it is not finite";
};

template <typename Kind>
std::unique_ptr<Reduction> make_reduction(const ReductionSetup& setup) {
  return std::make_unique<Kind>(setup);
}

/// The reductions that every scenario has.
const std::vector<MetricKind>& standard_metric_kinds();

}  // namespace breakwater
