// Studies as array jobs of Slurm, and as tasks of any other scheduler.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/study/study_folder.h>

namespace breakwater {

/// The request to the cluster.
struct SlurmRequest {
  std::size_t tasks = 100;           ///< at most
  std::size_t parallel = 0;          ///< tasks at the same time; 0: no limit
  std::vector<std::string> options;  ///< options for sbatch, one word each
  std::vector<std::string> of_task;  ///< further options of the command of each task: "--isolate"
};

/// The largest number of tasks in one array job. Throws std::invalid_argument if there is no
/// cluster or it does not answer.
std::size_t most_tasks();

/// Throws std::invalid_argument if a path has a control character: a newline would begin a command.
void check_for_scripts(const StudyFolder& folder);

struct SubmittedJob {
  std::string number;
  std::size_t tasks = 0;
};

/// Submits `points` as one array job, DIR/slurm/N. A task calls `breakwater COMMAND DIR --quiet
/// OPTIONS --points POINTS`. Throws std::invalid_argument with sbatch's message.
SubmittedJob submit(const StudyFolder& folder, const std::vector<std::size_t>& points,
                    const SlurmRequest& request);

/// A task of a submission. Its log may be missing.
struct SlurmTask {
  bool is_queued = false;
  std::filesystem::path log;
  std::vector<std::size_t> points;
};

/// The tasks of all submissions of a study, the last submission first.
struct Queued {
  std::string text;  ///< "job 12: 3 RUNNING, 5 PENDING (Resources)"; empty if nothing is queued
  std::vector<SlurmTask> tasks;

  /// For each point of the study: whether a queued task has it.
  std::vector<bool> points(std::size_t count) const;
};

/// Asks squeue if there is a submission. Throws std::invalid_argument, one line, if that fails, and
/// OutputError if the script that asks cannot be run.
Queued queued(const StudyFolder& folder, std::size_t points);

/// The same, but if the cluster does not answer it prints so on stderr and returns nothing.
std::optional<Queued> queued_if_known(const StudyFolder& folder, std::size_t points);

/// Throws std::invalid_argument, one line that begins with `what`, if a task is in the queue.
void check_not_queued(const Queued& queue, const StudyFolder& folder, const std::string& what);

/// Prints the queue, and the last log lines of tasks that ended before their points were done.
/// Points that were submitted again do not count.
void print_slurm_status(const StudyFolder& folder, const ShardIndex& index);

/// Waits until the queue has no task of the study, or a signal comes. It goes on waiting if the
/// cluster does not answer for a while. Throws OutputError as queued().
void wait_for_queue(const StudyFolder& folder, std::size_t points);

/// Prints commands that together run `points`, one per line.
void print_tasks(const StudyFolder& folder, const std::vector<std::size_t>& points,
                 const SlurmRequest& request);

/// The points of "0-99,120", or of the line "@FILE:LINE" with such a text. Throws
/// std::invalid_argument.
std::vector<std::size_t> points_of_task(const std::string& text, std::size_t size);

inline constexpr const char* kOnCluster = "On a cluster";  ///< the group of options

/// Adds --tasks, --parallel and --sbatch. Their default values are those of the request.
void add_slurm_options(CLI::App& app, SlurmRequest& request);

}  // namespace breakwater
