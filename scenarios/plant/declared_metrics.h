// Metrics that a file declares: [metric.NAME].
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <breakwater/config/fields.h>
#include <breakwater/linear/high_pass.h>
#include <breakwater/record/metric_definition.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/signals/signal.h>

namespace breakwater {

enum class DeclaredKind {
  rms,
  mean,
  max,
  min,
  peak,
  settling,
  overshoot,
  reach,
  rms_change,
  time_above,
  onsets
};

/// The value that is taken from the signal.
enum class Taken {
  value,
  difference,  ///< its change since the last value, divided by the period; 0 at the first value
  high_pass,
  largest  ///< the largest of a signal's several values
};

/// The keys of one metric.
struct DeclaredMetric {
  std::string name;
  std::string of;
  std::string minus;
  DeclaredKind kind = DeclaredKind::rms;
  double from_s = 0.0;
  double to_s = 0.0;  ///< 0: the end of the run
  double level = 0.0;
  Taken take = Taken::value;
  double cutoff_Hz = 0.0;  ///< cut-off of the high-pass

  std::string prefix() const { return "metric." + name + "."; }
  void bind(Fields& fields);

  TimeWindow window() const;
  /// The name with its unit, the unit and the meaning.
  MetricDefinition definition() const;
};

/// The reason why a metric does not apply: it needs a signal that is not there. Empty if it does.
/// Throws std::invalid_argument if it needs one value of a signal with several.
std::string missing_signal(const DeclaredMetric& metric, const std::vector<Signal>& signals);

/// Computes a declared metric, value by value.
class DeclaredValue {
 public:
  /// The signals must be there, and outlive it. Values are added every `period_s`. Throws
  /// std::invalid_argument if the cut-off is too high for that.
  DeclaredValue(const DeclaredMetric& metric, const std::vector<Signal>& signals, double end_s,
                double period_s);

  const DeclaredMetric& metric() const { return metric_; }
  void add(double time_s);
  /// Nothing if it does not apply to the run.
  std::optional<double> value() const;
  /// The reason why there is no value.
  std::string why_absent() const;

 private:
  double taken();

  DeclaredMetric metric_;
  std::span<const double> of_;
  std::span<const double> minus_;
  double period_s_;
  TimeWindow window_;
  std::optional<HighPass> high_pass_;
  WindowStatistics values_;
  WindowStatistics changes_;
  SettlingTime settling_;
  ReachTime reach_;
  std::optional<double> first_;  // the first value of the window
  std::optional<double> last_;
  std::optional<double> last_of_;  // for a difference
  double beyond_ = 0.0;            // the farthest value on the other side of 0
  double time_above_s_ = 0.0;
  int onsets_ = 0;
};

}  // namespace breakwater
