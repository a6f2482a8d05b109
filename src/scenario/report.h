// The tables that runs end with.
#pragma once

#include <string>
#include <vector>

#include "scenario/runner.h"
#include "scenario/scenario.h"

namespace breakwater {

/// One run: each metric with its unit and, where the thesis prints it, the printed value.
std::string metrics_table(const std::string& scenario, const RunSummary& run);

/// Several runs side by side, one column each; rows are the metrics that any of them has, with the
/// printed values and the deviations from them below. A deviation outside of what counts as
/// reproduced is marked.
std::string comparison_table(const std::string& scenario, const std::vector<RunSummary>& runs,
                             std::size_t width);

/// One table for each of the matrix' metrics: cases down, values across. `runs` are those of the
/// first value, then those of the second, ….
std::string matrix_tables(const Matrix& matrix, const std::vector<RunSummary>& runs,
                          std::size_t width);

}  // namespace breakwater
