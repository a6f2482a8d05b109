// A tuning's runs as tasks of a Slurm cluster. A search stays in one process: its tasks are told
// what the keys of their runs are, so that nodes of any kind serve it.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <vector>

#include <breakwater/cluster/slurm.h>
#include <breakwater/search/tuning_plan.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// Tasks have ended again and again, and some runs are still not there.
class RunsMissing : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a tuning asks of its cluster.
struct ClusterTuning {
  StudyFolder folder;
  SlurmRequest request;
  bool quiet = false;
  /// Makes a run here, to tell how long the others take.
  std::function<void(const std::vector<std::size_t>& runs)> make_here;
};

/// Submits runs as one array job and waits until all of them are in the folder's shards; what is
/// not there when the tasks have ended, or is in the queue already, it submits again, or waits for.
/// Throws RunsMissing once three jobs in a row brought nothing, Interrupted, which leaves what is
/// in the queue there, and std::invalid_argument if Slurm refuses.
void run_on_slurm(const TuningPlan& plan, const ClusterTuning& cluster,
                  const std::vector<std::size_t>& runs);

}  // namespace breakwater
