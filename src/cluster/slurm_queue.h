// What a study has submitted to a Slurm cluster, and what became of it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// One array job: DIR/slurm/N with job.sh, tasks (the points of each task, a line each), job (its
/// number) and TASK.log; of a tuning also candidates (what its runs' keys are).
struct Submission {
  std::filesystem::path folder;
  std::string job;
  std::vector<std::string> tasks;
};

/// All that were accepted, in their order. Throws std::invalid_argument if DIR/slurm cannot be
/// read.
std::vector<Submission> submissions(const StudyFolder& folder);

/// What of a study is in the queue.
struct Queued {
  std::vector<bool> points;  ///< of the study: whether a task has it that is not over
  bool is_asked = false;     ///< whether anything was submitted, so that squeue was asked
  std::string text;          ///< "job 12: 3 RUNNING, 5 PENDING (Resources)"; empty if nothing is
};

/// Asks squeue, if anything was submitted. Throws std::invalid_argument, one line, if that fails.
Queued queued(const StudyFolder& folder, std::size_t points);

/// The same where the cluster need not answer: nothing, once that is said on stderr.
std::optional<Queued> queued_if_known(const StudyFolder& folder, std::size_t points);

/// Throws std::invalid_argument, one line that begins with `what`, if something is in the queue.
void check_not_queued(const Queued& queue, const StudyFolder& folder, const std::string& what);

/// Prints what the queue has, and the last words of tasks that ended before their points were done,
/// unless these were submitted again.
void print_slurm_status(const StudyFolder& folder, const ShardIndex& index);

/// What a program of Slurm's prints. Throws std::invalid_argument `PROGRAM: REASON` with what it
/// says if it fails.
std::vector<std::string> ask_slurm(const std::vector<std::string>& words);

}  // namespace breakwater
