// A tuning's runs as tasks of a Slurm cluster. A search stays in one process: its tasks are told
// what the keys of their runs are, so that nodes of any kind serve it.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/study/slurm.h>
#include <breakwater/study/study_folder.h>
#include <breakwater/tuning/tuning_plan.h>

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
};

/// Submits runs as one array job and waits until all of them are in the folder's shards; what is
/// not there when the tasks have ended, or is in the queue already, it submits again, or waits for.
/// Throws RunsMissing once three jobs in a row brought nothing, Interrupted, which leaves what is
/// in the queue there, and std::invalid_argument if Slurm refuses.
void run_on_slurm(const TuningPlan& plan, const ClusterTuning& cluster,
                  const std::vector<std::size_t>& runs);

/// Makes those runs of "@DIR/slurm/N/tasks:LINE" that are not there yet, `jobs` at a time (0: as
/// many as the task was given). Returns whether it got to the end, or was stopped after the runs
/// under way. Throws std::invalid_argument, OutputError.
bool run_task(TuningPlan& plan, const StudyFolder& folder, const std::string& points,
              std::size_t jobs);

}  // namespace breakwater
