// The tables that runs end with.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <breakwater/scenario/runner.h>
#include <breakwater/scenario/scenario.h>

namespace breakwater {

/// A number that somebody else has for a metric of a case: one that is printed, say.
struct ReferenceValue {
  std::string metric;
  double number;
  std::string text;                       ///< as it is written there
  bool is_near_zero;                      ///< a part of it says nothing
  std::function<bool(double)> is_met_by;  ///< whether a measured number agrees with it
};

/// Where such numbers come from.
struct References {
  /// Those of a case of a scenario; may be empty: there are none at all.
  std::function<std::vector<ReferenceValue>(const std::string& scenario,
                                            const std::string& case_name)>
      of_case;
  std::string legend;  ///< what "*" means, beside a number that does not agree
};

/// One run: each metric with its unit and, where there is one, the printed value.
std::string metrics_table(const std::string& scenario, const RunSummary& run,
                          const References& references);

/// Several runs side by side, one column each; rows are the metrics that any of them has, with the
/// printed values and the deviations from them below. A deviation that does not agree is marked.
std::string comparison_table(const std::string& scenario, const std::vector<RunSummary>& runs,
                             const References& references, std::size_t width);

/// One table for each of the matrix' metrics: cases down, values across. `runs` are those of the
/// first value, then those of the second, ….
std::string matrix_tables(const Matrix& matrix, const std::vector<RunSummary>& runs,
                          std::size_t width);

/// The table with what did not come out (failed, or marked) in colour, if `colourful`.
std::string with_colours(const std::string& table, bool colourful);

/// Runs as JSON: `scenario`, and of each of `runs` its `case`, `folder`, `status`, where it failed
/// `time_s` and `reason`, its `metrics`, and of those that are printed somewhere `printed`: `value`
/// and whether ours `agrees` with it.
std::string runs_json(const std::string& scenario, const std::vector<RunSummary>& runs,
                      const References& references);

}  // namespace breakwater
