// The table [slurm] in the file of a study or tuning.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

class TomlEntry;

/// Settings of jobs on a Slurm cluster.
struct SlurmSettings {
  std::string account;
  std::string partition;
  std::string constraint;
  std::vector<std::string> modules;      ///< loaded by a task
  std::vector<std::string> environment;  ///< NAME=VALUE, set by a task
  std::vector<std::string> options;      ///< further options of sbatch: "--time=1:00:00"

  /// The table as TOML; empty if nothing is set.
  std::string print() const;
};

/// A complaint about options of sbatch that would override those of the job script, such as
/// --array; empty if there are none.
std::string overriding(const std::string& options);

/// Reads the table from a file's root. Without [slurm] nothing is set. Throws std::invalid_argument
/// (`FILE:LINE: key: reason`).
SlurmSettings read_slurm(const TomlEntry& root);

}  // namespace breakwater
