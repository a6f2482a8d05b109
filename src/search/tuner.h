// A tuning under way, and what comes out of it.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <breakwater/search/evaluation.h>
#include <breakwater/search/tuning_plan.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// One point of a case's front.
struct FrontPoint {
  std::size_t evaluation = 0;
  Evaluation tuned;
  std::optional<Evaluation> fresh = {};  ///< in the worlds of the validation, if it was chosen
};

struct TunedFront {
  std::string case_name;
  std::vector<FrontPoint> points;                           ///< the first objective's best first
  std::vector<Evaluation> evaluations;                      ///< all, in the search's order
  std::vector<std::pair<std::size_t, double>> hypervolume;  ///< after so many evaluations
};

struct TuningResult {
  std::vector<double> reference;  ///< of the hypervolumes, all goals min
  std::vector<TunedFront> fronts;
  std::vector<PointResult> runs;  ///< all, in the order of their numbers
};

struct TunerOptions {
  std::size_t jobs = 0;  ///< 0: as many as there are cores
  const std::atomic<bool>* stop = nullptr;
  std::function<void(std::size_t run)> on_run = {};  ///< a run is done, now or earlier; thread-safe
  /// The validations begin: these runs, in no order, once the fronts are known.
  std::function<void(const std::vector<std::size_t>& runs)> on_validation = {};
  /// Makes runs elsewhere: they are in the folder's shards when it returns. Empty: they are made
  /// here. What it throws ends the tuning.
  std::function<void(const std::vector<std::size_t>& runs)> elsewhere = {};
};

/// Runs the searches of all cases and the validations, each generation on all cores. What a shard
/// of the folder holds is not run again: the search asks for the same candidates again and is
/// answered from there, so that it goes on where it was, with the same result. Throws Interrupted
/// if it is stopped, std::invalid_argument for what ends it, OutputError.
TuningResult tune(TuningPlan& plan, const StudyFolder& folder, const TunerOptions& options);

}  // namespace breakwater
