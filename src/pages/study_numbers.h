// The results of a study in groups, for its report.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <breakwater/statistics/sensitivity.h>
#include <breakwater/study/result_row.h>
#include <breakwater/study/results.h>

namespace breakwater {

/// Puts these metrics first, as far as the runs have them.
void put_first(const std::vector<std::string>& first, StudyNumbers& numbers);

/// Statistics of a metric over the runs of one group. Quantiles are NaN if no run has the metric.
struct QuantileBand {
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t measured = 0;  ///< runs that have the metric
  double q10 = std::numeric_limits<double>::quiet_NaN();
  double q25 = q10, median = q10, q75 = q10, q90 = q10;
  double smallest = q10, largest = q10;
  /// Numbers of points: at the smallest value, at the median (the lower one of two), at the
  /// largest, and of the first failed run.
  std::size_t at_smallest = 0, at_middle = 0, at_largest = 0, first_failed = 0;
};

/// Medians and quantiles (quantile(), with interpolation) of `groups` groups of runs. The first of
/// equal values counts as the smallest. `column` has a value, or NaN, for each run; group_of(run) <
/// groups.
std::vector<QuantileBand> bands(const StudyNumbers& numbers, const std::vector<double>& column,
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
