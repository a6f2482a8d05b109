// The results of a run.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/record/track.h>

namespace breakwater {

/// One finite number that describes a run. One that does not apply or is not finite is left out.
struct Metric {
  /// Throws std::invalid_argument, one line, unless the name is_column_name().
  Metric(std::string its_name, std::string its_unit, double its_value);

  std::string name;  ///< unit included: "peak_force_raw_N"
  std::string unit;  ///< as people write it: "N"
  double value;
};

/// The value of the metric with this name; nothing if there is none.
std::optional<double> metric_in(const std::vector<Metric>& metrics, const std::string& name);

/// Appends a metric if it has a finite value.
inline void add(std::vector<Metric>& metrics, const std::string& name, const std::string& unit,
                const std::optional<double>& value) {
  if (value && std::isfinite(*value)) metrics.push_back({name, unit, *value});
}

/// A metric that the file of a run asks for and the run does not have.
struct AbsentMetric {
  std::string name;
  std::string unit;
  std::string reason;
};

/// The reason why a run did not reach its end.
struct Failure {
  double time_s;
  std::string reason;
  bool is_cut = false;  ///< its process ended before the run did

  const char* verb() const { return is_cut ? "was cut" : "failed"; }
};

struct Recording {
  std::vector<Track> tracks;
  std::vector<Metric> metrics;       ///< empty if the run failed
  std::vector<AbsentMetric> absent;  ///< for the tables of runs
  /// Times measured by a clock: only they may differ between two equal runs. Empty if it failed.
  std::vector<Metric> costs;
  std::optional<Failure> failure;
  std::vector<std::string> warnings;  ///< problems of a complete run, one line each
  std::uint64_t state_hash = 0;
  double simulated_s = 0.0;
  std::int64_t dropped_samples = 0;

  /// The track with this name. Throws std::out_of_range if there is none.
  const Track& track(const std::string& name) const;
  std::optional<double> metric(const std::string& name) const { return metric_in(metrics, name); }
};

/// The meaning of a metric or a cost.
struct MetricDefinition {
  std::string name;  ///< as in the Metric
  std::string unit;  ///< as in the Metric
  std::string text;  ///< one sentence without a full stop
};

/// The `metrics` with these `names` (Scenario::main_metrics), in that order. If empty, the first
/// two.
std::vector<Metric> main_metrics(const std::vector<std::string>& names,
                                 const std::vector<Metric>& metrics);

/// "free_motion_time_s 0.5302  peak_force_filtered_N 2.317".
std::string brief(const std::vector<Metric>& metrics);

}  // namespace breakwater
