// A metric's spread over groups of runs: what stands behind a study's charts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <breakwater/report/study_numbers.h>

namespace breakwater {

/// A key's values in groups: each value its own where they are few, else neighbours together, about
/// as many samples in each.
struct KeyGroups {
  std::string name;
  bool is_number = true;
  bool is_binned = false;           ///< a group has several values
  bool is_log = false;              ///< positive numbers that are spread more evenly in log x
  std::vector<double> centre;       ///< x of a group: the median of its samples' values
  std::vector<std::string> labels;  ///< "8", "0.061 to 0.07"
  std::vector<std::uint16_t> of_sample;

  std::size_t size() const { return centre.size(); }
};

/// At most `most` groups of a key, 1 ≤ most ≤ 65536; in the numbers' order, texts in the study's.
KeyGroups group_values(const StudyKey& key, std::size_t most);

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
