// Studies as array jobs of Slurm, and as tasks of any other scheduler.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <breakwater/study/slurm_settings.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// What is asked of the cluster.
struct SlurmRequest {
  std::size_t tasks = 0;             ///< 0: as many as `minutes` make
  double minutes = 30.0;             ///< that a task is to take
  std::size_t parallel = 0;          ///< tasks at a time; 0: no limit
  std::vector<std::string> options;  ///< of sbatch, words apart
  std::vector<std::string> of_task;  ///< further options of each task: "--isolate"
};

/// Whose points they are: each task calls `breakwater COMMAND DIR --quiet OPTIONS --points POINTS`.
struct SlurmStudy {
  StudyFolder folder;
  SlurmSettings settings = {};
  std::string candidates = {};  ///< of a tuning: DIR/slurm/N/candidates, what its runs' keys are
};

/// How many tasks one array job may have here. Throws std::invalid_argument if the cluster does not
/// answer, or there is none.
std::size_t most_tasks();

/// Throws std::invalid_argument if a path that stands in scripts has a control character: a newline
/// would begin a command there.
void check_for_scripts(const StudyFolder& folder);

struct SubmittedJob {
  std::string number;
  std::size_t tasks = 0;
};

/// Submits `points` as one array job, DIR/slurm/N. How many seconds of processor time they take
/// altogether is asked for if the request does not say how many tasks there are to be. Throws
/// std::invalid_argument with what sbatch says if it refuses.
SubmittedJob submit(const SlurmStudy& study, const std::vector<std::size_t>& points,
                    const SlurmRequest& request, const std::function<double()>& seconds);

/// Until nothing of the study is in the queue, or a signal comes. That the cluster does not answer
/// for a while is no end.
void wait_for_queue(const StudyFolder& folder, std::size_t points);

/// Prints commands that together run `points`, one a line.
void print_tasks(const SlurmStudy& study, const std::vector<std::size_t>& points,
                 const SlurmRequest& request);

/// The points of "0-99,120" or of "@FILE:LINE", a line of such. Throws std::invalid_argument.
std::vector<std::size_t> points_of_task(const std::string& text, std::size_t size);

/// DIR/slurm/N of the points "@DIR/slurm/N/tasks:LINE". Throws std::invalid_argument.
std::filesystem::path submission_of_task(const std::string& text);

/// How many runs at a time a task may make: what its scheduler gave it.
std::size_t task_threads();

}  // namespace breakwater
