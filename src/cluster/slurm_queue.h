// The submissions of a study to a Slurm cluster, and their state.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// The part of a study that is in the queue.
struct Queued {
  std::vector<bool> points;  ///< for each point of the study: whether an unfinished task has it
  bool is_asked = false;     ///< whether squeue was asked, since there is a submission
  std::string text;          ///< "job 12: 3 RUNNING, 5 PENDING (Resources)"; empty if nothing is
};

/// Asks squeue if there is a submission. Throws std::invalid_argument, one line, if that fails.
Queued queued(const StudyFolder& folder, std::size_t points);

/// The same, but if the cluster does not answer it prints so on stderr and returns nothing.
std::optional<Queued> queued_if_known(const StudyFolder& folder, std::size_t points);

/// Throws std::invalid_argument, one line that begins with `what`, if a task is in the queue.
void check_not_queued(const Queued& queue, const StudyFolder& folder, const std::string& what);

/// Prints the queue, and the last log lines of tasks that ended before their points were done.
/// Points that were submitted again do not count.
void print_slurm_status(const StudyFolder& folder, const ShardIndex& index);

/// The output lines of a Slurm program. Throws std::invalid_argument `PROGRAM: REASON` if it fails.
std::vector<std::string> ask_slurm(const std::vector<std::string>& words);

}  // namespace breakwater
