// A metric's spread over groups of runs: what stands behind a study's charts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <breakwater/pages/study_numbers.h>

namespace breakwater {

/// A metric over the runs of one group. Quantiles are NaN where no run has it.
struct QuantileBand {
  std::size_t runs = 0;
  std::size_t failed = 0;
  std::size_t measured = 0;  ///< runs that have the metric
  double q10 = std::numeric_limits<double>::quiet_NaN();
  double q25 = q10, median = q10, q75 = q10, q90 = q10;
  double smallest = q10, largest = q10;
  /// Numbers of points: of the smallest value, of the middle one (of two the smaller), of the
  /// largest, and of the first run that failed.
  std::size_t at_smallest = 0, at_middle = 0, at_largest = 0, first_failed = 0;

  double failed_share() const {
    return runs == 0 ? q10 : static_cast<double>(failed) / static_cast<double>(runs);
  }
};

/// A column's runs that have a finite value, smallest first; equal ones in the runs' order.
std::vector<std::uint32_t> in_order(const std::vector<double>& column);

/// Medians and quantiles (quantile(), between the values) of `groups` groups of runs. `column` may
/// be empty: of a metric that no run has. `order` is in_order() of it; group_of(run) < groups.
std::vector<QuantileBand> bands(const StudyNumbers& numbers, const std::vector<double>& column,
                                const std::vector<std::uint32_t>& order, std::size_t groups,
                                const std::function<std::size_t(const StudyRun&)>& group_of);

}  // namespace breakwater
