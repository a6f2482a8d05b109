// Evaluation of a candidate from its runs.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/search/tuning.h>
#include <breakwater/statistics/confidence_interval.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// One number from many runs, with a 95 % confidence interval if there is one.
struct GatheredValue {
  double value;
  std::optional<ConfidenceInterval> interval = {};
};

/// The evaluation of one candidate over all its runs. A run fails if it does not end or lacks a
/// named metric.
struct Evaluation {
  std::size_t runs = 0;
  std::size_t failures = 0;
  std::vector<GatheredValue> objectives;   ///< empty after a failure
  std::vector<GatheredValue> constraints;  ///< empty after a failure
  double violation = 0.0;  ///< Σ of the distances to violated bounds, relative to the bounds

  bool is_feasible() const { return failures == 0 && violation == 0.0; }
};

/// A metric of a run, or nothing.
std::optional<double> metric_of(const PointResult& run, const std::string& metric);

/// `with_intervals` adds quantile_interval() to a median and to q90.
/// `worst` has no interval.
Evaluation evaluate(const Tuning& tuning, const std::vector<PointResult>& runs,
                    bool with_intervals);

/// The objectives, with the sign changed for the goal max.
std::vector<double> minimised(const Tuning& tuning, const Evaluation& evaluation);

/// The objectives for the search: minimised() if feasible. If not, all objectives are one number
/// above every feasible value. It grows with the violation and is larger still if a run failed. So
/// a feasible candidate dominates every infeasible one. The number also grows slightly with
/// `number`, since pagmo divides by the spread of a front.
std::vector<double> fitness(const Tuning& tuning, const Evaluation& evaluation, std::size_t number);

}  // namespace breakwater
