// Runs of a tuning as tasks of a Slurm cluster. The search stays in one process and sends the
// values of the keys to its tasks, so the nodes may be of any kind.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <vector>

#include <breakwater/cluster/slurm.h>
#include <breakwater/search/tuning_plan.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// Several jobs in a row ended without new runs.
class RunsMissing : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Settings of a tuning on a cluster.
struct ClusterTuning {
  StudyFolder folder;
  SlurmRequest request;
  bool quiet = false;
  /// Makes some runs here to estimate the time of the others.
  std::function<void(const std::vector<std::size_t>& runs)> make_here;
};

/// Submits runs as an array job and waits until all of them are in the shards of the folder. Runs
/// that are missing after the job are submitted again, unless they are still in the queue. Throws
/// RunsMissing after three jobs in a row without a result, Interrupted (the queue stays as it is),
/// and std::invalid_argument if Slurm refuses.
void run_on_slurm(const TuningPlan& plan, const ClusterTuning& cluster,
                  const std::vector<std::size_t>& runs);

}  // namespace breakwater
