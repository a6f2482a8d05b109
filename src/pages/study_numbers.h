// The results of a study as columns, for its report.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <breakwater/statistics/sensitivity.h>
#include <breakwater/study/plan.h>
#include <breakwater/study/result_row.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// The data of one run that the charts need.
struct StudyRun {
  std::size_t number = 0;      ///< number of the point
  std::uint32_t sample = 0;    ///< that of the plan, index into StudyKey::values
  std::uint32_t block = 0;     ///< saltelli design: its row; others: the sample
  std::uint32_t in_block = 0;  ///< saltelli design: its column A, AB⁽¹⁾ … B; others: 0
  std::uint32_t candidate = 0;
  bool failed = false;  ///< not complete, for any reason
};

/// Runs that failed for the same reason, apart from the numbers in it.
struct FailureKind {
  PointStatus status = PointStatus::failed;
  std::string reason;  ///< reason of the first run
  std::size_t runs = 0;
  std::vector<std::size_t> of_candidate;  ///< number of runs per candidate
  std::vector<std::size_t> first;         ///< numbers of the first points
};

struct StudyNumbers {
  std::vector<StudyKey> keys;
  std::vector<StudyRun> runs;  ///< in the order of the points
  std::vector<std::string> metrics;
  std::vector<std::vector<double>> columns;  ///< for each metric, by run; NaN: not measured
  std::size_t blocks = 0;                    ///< 1 + the largest of the runs
  std::vector<FailureKind> failures;         ///< most runs first
};

/// Reads each result once. The metrics in `first` come first; the others follow in the order of the
/// points.
StudyNumbers study_numbers(const Plan& plan, const ShardIndex& index,
                           const std::vector<std::string>& first);

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
