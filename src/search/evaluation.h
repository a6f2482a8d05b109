// What a candidate's runs are worth.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <breakwater/search/tuning.h>
#include <breakwater/statistics/confidence_interval.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// A number gathered from runs, with an interval at 95 % where there is one.
struct GatheredValue {
  double value;
  std::optional<ConfidenceInterval> interval = {};
};

/// All runs of one candidate, gathered. A run that did not end, or lacks a metric that is asked
/// for, is a failure.
struct Evaluation {
  std::size_t runs = 0;
  std::size_t failures = 0;
  std::vector<GatheredValue> objectives;   ///< none if anything failed
  std::vector<GatheredValue> constraints;  ///< the same
  double violation = 0.0;  ///< Σ of how far beyond its bound each is, in parts of it

  bool is_feasible() const { return failures == 0 && violation == 0.0; }
};

/// With `with_intervals`: of a median and of q90 quantile_interval(), of a mean bca_interval(); the
/// worst of some runs has none.
Evaluation evaluate(const Tuning& tuning, const std::vector<PointResult>& runs,
                    bool with_intervals);

/// The objectives with all goals min.
std::vector<double> minimised(const Tuning& tuning, const Evaluation& evaluation);

/// What a search is told: minimised() if feasible; else the same number for every objective, larger
/// than any value of a feasible one, and the larger the more it violates; larger still if a run
/// failed. So a feasible candidate dominates every other, and one that survives every one that does
/// not. No two that are not feasible are told the same, the later (by `number`) the larger: pagmo
/// divides by the spread of a front.
std::vector<double> fitness(const Tuning& tuning, const Evaluation& evaluation, std::size_t number);

}  // namespace breakwater
