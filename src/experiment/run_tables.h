// The tables at the end of runs.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/scenario.h>

namespace breakwater {

/// One run: each metric with its unit and its reference value, if any (references.h).
std::string metrics_table(const std::string& scenario, const RunSummary& run,
                          const Catalogue& catalogue);

/// Several runs, one column each. The rows are all their metrics, with the printed values and the
/// deviations from them below. A mark shows a deviation that does not agree.
std::string comparison_table(const std::string& scenario, const std::vector<RunSummary>& runs,
                             const Catalogue& catalogue, std::size_t width);

/// One table for each metric of the matrix, with a row per case and a column per value. `runs` has
/// the runs of the first value, then those of the second, ….
std::string matrix_tables(const Matrix& matrix, const std::vector<RunSummary>& runs,
                          std::size_t width);

}  // namespace breakwater
