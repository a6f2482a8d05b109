// The answers of Slurm's programs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// A task of an array job in the queue.
struct QueuedTask {
  std::string job;
  std::size_t index = 0;  ///< in the array, counted from 1
  std::string state;
  std::string reason;  ///< the reason for waiting
};

/// The format for squeue whose lines queued_tasks() reads.
inline constexpr const char* kQueueFormat = "%F|%K|%T|%r";

/// The tasks in the lines of squeue. Other lines do not count.
std::vector<QueuedTask> queued_tasks(const std::vector<std::string>& lines);

/// A number in the lines of `scontrol show config`. Throws std::invalid_argument if it is not there
/// or not positive.
std::size_t slurm_limit(const std::vector<std::string>& lines, const std::string& name);

/// The number of the accepted job in the lines of sbatch, among warnings, which it moves to
/// `warnings`. Throws std::invalid_argument if there is none.
std::string accepted_job(const std::vector<std::string>& lines, std::vector<std::string>& warnings);

}  // namespace breakwater
