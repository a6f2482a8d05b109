// The tables that runs end with.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/scenario.h>

namespace breakwater {

/// One run: each metric with its unit and, where there is one, its reference value (references.h).
std::string metrics_table(const std::string& scenario, const RunSummary& run,
                          const Catalogue& catalogue);

/// Several runs side by side, one column each; rows are the metrics that any of them has, with the
/// printed values and the deviations from them below. A deviation that does not agree is marked.
std::string comparison_table(const std::string& scenario, const std::vector<RunSummary>& runs,
                             const Catalogue& catalogue, std::size_t width);

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
                      const Catalogue& catalogue);

}  // namespace breakwater
