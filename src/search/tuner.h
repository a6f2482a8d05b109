// The execution of a tuning and its result.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/search/tuning.h>
#include <breakwater/search/tuning_plan.h>
#include <breakwater/statistics/distribution.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// The evaluation of one candidate over all its runs. A run fails if it does not end or lacks a
/// named metric.
struct Evaluation {
  std::size_t runs = 0;
  std::size_t failures = 0;
  std::vector<EstimatedValue> objectives;   ///< empty after a failure
  std::vector<EstimatedValue> constraints;  ///< empty after a failure
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

/// One point of a Pareto front, or the best candidate for one objective.
struct FrontPoint {
  std::size_t evaluation = 0;
  Evaluation tuned;
  std::optional<Evaluation> fresh =
      {};  ///< in the test conditions of the validation, if it was chosen
};

struct TunedFront {
  std::string case_name;
  std::vector<FrontPoint> points;       ///< in the order of the first objective, best first
  std::vector<Evaluation> evaluations;  ///< all, in the order of the search
};

struct TuningResult {
  std::vector<TunedFront> fronts;
  std::map<std::size_t, PointResult> runs;  ///< by number
};

struct TunerOptions {
  std::size_t jobs = 0;  ///< 0: the number of cores
  const std::atomic<bool>* stop = nullptr;
  std::function<void(std::size_t run)> on_run =
      {};  ///< a run is finished, now or earlier; thread-safe
  std::function<void(std::size_t runs)> on_validation = {};  ///< it begins, with so many runs
  /// Makes runs elsewhere and writes them to the shards of the folder. Empty: the runs are made
  /// here. An exception ends the tuning.
  std::function<void(const std::vector<std::size_t>& runs)> elsewhere = {};
};

/// Runs the searches of all cases and the validation, each generation on all cores. Runs in the
/// shards are not repeated: the search asks for the same candidates again and gets the stored
/// results. So it continues an interrupted tuning with the same result. Throws Interrupted,
/// std::invalid_argument and OutputError.
TuningResult tune(TuningPlan& plan, const StudyFolder& folder, const TunerOptions& options);

}  // namespace breakwater
