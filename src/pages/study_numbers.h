// The results of a study in groups, for its report.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <breakwater/statistics/sensitivity.h>
#include <breakwater/study/result_row.h>
#include <breakwater/study/results.h>

namespace breakwater {

/// Puts these metrics first, as far as the runs have them.
void put_first(const std::vector<std::string>& first, StudyNumbers& numbers);

/// The runs of one group, with the values of a metric.
struct RunGroup {
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t first_failed = 0;     ///< number of the point
  std::vector<double> values;       ///< sorted, of the runs that have the metric
  std::vector<std::size_t> points;  ///< the number of each one's point

  /// quantile(), with interpolation; NaN without values.
  double at(double share) const;
};

/// `groups` groups of runs. `column` has a value, or NaN, for each run; group_of(run) < groups.
std::vector<RunGroup> grouped(const StudyNumbers& numbers, const std::vector<double>& column,
                              std::size_t groups,
                              const std::function<std::size_t(const StudyRun&)>& group_of);

/// The output 1 for a failed run and 0 for another one.
inline constexpr const char* kFailedOutput = "failed";

/// The rows of indices.csv: sensitivity_indices() for each output, candidate and key, with the
/// outputs in the order of the metrics and the failures last. An output is the mean over the seeds
/// of a metric, or the share of failed seeds. It is missing for a sample if a seed has no value.
/// There are 1000 replicates, or fewer for a very large study, but at least 200. Columns:
/// `candidate`, `output`, `key`, `first_order`, `first_order_lower`, `first_order_upper`, `total`,
/// `total_lower`, `total_upper`, `rows`, `dropped_rows`. A missing value is empty.
std::vector<ResultRow> study_indices(const StudyNumbers& numbers,
                                     const std::vector<std::string>& labels);

}  // namespace breakwater
