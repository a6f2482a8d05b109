// A run's folder: complete or absent.
#pragma once

#include <filesystem>
#include <vector>

#include "record/output_error.h"

namespace breakwater {

/// Files are written into a folder beside the final one, which takes its name only when whole. An
/// earlier run of that name is swapped out. Without commit(), nothing is left behind, not even the
/// parent folders that were made for it.
class RunFolder {
 public:
  /// Throws std::invalid_argument if the target is a file, is a folder that holds something other
  /// than an earlier run, or cannot be made.
  explicit RunFolder(const std::filesystem::path& target);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Where to write.
  const std::filesystem::path& path() const { return partial_; }
  const std::filesystem::path& target() const { return target_; }

  /// Puts the folder in its place. Throws OutputError if that fails.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path partial_;
  std::vector<std::filesystem::path> made_parents_;  // innermost first
  bool committed_ = false;
};

/// Whether a folder is one that a run left, by its manifest.json.
bool is_run_folder(const std::filesystem::path& folder);

}  // namespace breakwater
