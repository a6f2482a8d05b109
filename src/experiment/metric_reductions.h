// Reductions of the values of a window to one number: the kinds of [metric.NAME].
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
};

/// The data of a reduction. They must outlive it.
struct ReductionSetup {
  const MetricWindow& window;
  const MetricExpression& level;
  const MetricExpression& lower;
  double period_s;     ///< time between the values
  std::size_t values;  ///< number of values that are added at a time
};

/// Reduces values to one number.
class Reduction {
 public:
  Reduction() = default;
  Reduction(const Reduction&) = delete;
  Reduction& operator=(const Reduction&) = delete;
  virtual ~Reduction() = default;

  /// Is called for each value of the window, in order. Allocates nothing.
  virtual void add(const AddedValues& added) = 0;
  /// Nothing if it does not apply. Is called after add().
  virtual std::optional<double> value() const = 0;
};

/// The unit of a reduction's number, for a signal with the unit N.
enum class ReducedUnit { signal, time, percent, one, rate, time_integral };

/// A reduction and its name.
struct MetricKind {
  std::string name;
  std::string meaning;  ///< follows the name of the signal and a colon
  ReducedUnit unit = ReducedUnit::signal;
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
