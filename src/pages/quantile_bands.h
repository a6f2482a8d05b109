// The spread of a metric over groups of runs, for the charts of a study.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <breakwater/pages/study_numbers.h>

namespace breakwater {

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

  double failed_share() const {
    return runs == 0 ? q10 : static_cast<double>(failed) / static_cast<double>(runs);
  }
};

/// The runs with a finite value in a column, in the order of the values. Equal values keep the
/// order of the runs.
std::vector<std::uint32_t> in_order(const std::vector<double>& column);

/// Medians and quantiles (quantile(), with interpolation) of `groups` groups of runs. `column` is
/// empty if no run has the metric. `order` is in_order(column). group_of(run) < groups.
std::vector<QuantileBand> bands(const StudyNumbers& numbers, const std::vector<double>& column,
                                const std::vector<std::uint32_t>& order, std::size_t groups,
                                const std::function<std::size_t(const StudyRun&)>& group_of);

}  // namespace breakwater
