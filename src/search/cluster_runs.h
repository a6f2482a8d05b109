// A tuning's runs as tasks of a Slurm cluster. A search stays in one process: its tasks are told
// what the keys of their runs are, so that nodes of any kind serve it.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
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
  bool isolate = false;
  bool quiet = false;
};

/// Runs that a scheduler or another process hands out.
struct TuningTask {
  std::string points;  ///< "0-99,120", or "@DIR/slurm/N/tasks:LINE"
  std::vector<std::string>
      candidates;        ///< candidate_lines(); empty: those of DIR/slurm/N/candidates
  std::size_t jobs = 0;  ///< 0: as many as the task was given
  bool isolate = false;
};

/// Submits runs as one array job and waits until all of them are in the folder's shards; what is
/// not there when the tasks have ended, or is in the queue already, it submits again, or waits for.
/// Throws RunsMissing once three jobs in a row brought nothing, Interrupted, which leaves what is
/// in the queue there, and std::invalid_argument if Slurm refuses.
void run_on_slurm(const TuningPlan& plan, const ClusterTuning& cluster,
                  const std::vector<std::size_t>& runs);

/// Makes those runs of a task that are not there yet. Returns whether it got to the end, or was
/// stopped after the runs under way. Throws std::invalid_argument, OutputError.
bool run_task(TuningPlan& plan, const StudyFolder& folder, const TuningTask& task);

}  // namespace breakwater
