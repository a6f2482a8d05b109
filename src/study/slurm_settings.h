// The table [slurm] of a study's or a tuning's file.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

class TomlEntry;

/// What jobs of a Slurm cluster are asked for.
struct SlurmSettings {
  std::string account;
  std::string partition;
  std::string constraint;
  std::vector<std::string> modules;      ///< that a task loads
  std::vector<std::string> environment;  ///< NAME=VALUE, that a task sets
  std::vector<std::string> options;      ///< further ones of sbatch: "--time=1:00:00"

  /// As a table of a file; empty if nothing is asked for.
  std::string print() const;
};

/// Reads them from a file's root; if it has no [slurm], nothing is asked for. Throws
/// std::invalid_argument `FILE:LINE: key: reason`.
SlurmSettings read_slurm(const TomlEntry& root);

}  // namespace breakwater
