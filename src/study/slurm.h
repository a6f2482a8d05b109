// Studies as array jobs of Slurm, and as tasks of any other scheduler.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <breakwater/study/study_folder.h>
#include <breakwater/study/sweep.h>

namespace breakwater {

/// What is asked of the cluster.
struct SlurmRequest {
  std::size_t tasks = 0;             ///< 0: as many as `minutes` make
  double minutes = 30.0;             ///< that a task is to take
  std::size_t parallel = 0;          ///< tasks at a time; 0: no limit
  std::vector<std::string> options;  ///< of sbatch, words apart
  std::vector<std::string> of_task;  ///< further options of each task: "--isolate"
  bool wait = false;
};

/// Submits `points` as one array job, DIR/slurm/N. Throws std::invalid_argument with what sbatch
/// says if it refuses.
void submit(const Sweep& sweep, const StudyFolder& folder, const std::vector<std::size_t>& points,
            const SlurmRequest& request, bool quiet);

/// Until nothing of the study is in the queue, or a signal comes. That the cluster does not answer
/// for a while is no end.
void wait_for_queue(const StudyFolder& folder, std::size_t points);

/// Prints commands that together run `points`, one a line.
void print_tasks(const StudyFolder& folder, const std::vector<std::size_t>& points,
                 const SlurmRequest& request);

/// The points of "0-99,120" or of "@FILE:LINE", a line of such. Throws std::invalid_argument.
std::vector<std::size_t> points_of_task(const std::string& text, std::size_t size);

/// How many runs at a time a task may make: what its scheduler gave it.
std::size_t task_threads();

}  // namespace breakwater
