// A run's folder: complete or absent.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <breakwater/record/output_error.h>

namespace breakwater {

/// What processes left beside the runs in a folder, listed once: where very many runs are written
/// into it, listing it for each of them would take a time that grows with their square.
class LeftBeside {
 public:
  explicit LeftBeside(const std::filesystem::path& folder);
  /// What follows `begin` in the names that begin so.
  std::vector<std::string> behind(const std::string& begin) const;

 private:
  std::set<std::string> names_;
};

/// Files are written into a folder beside the final one, which takes its name only when whole and
/// on the disk. An earlier run of that name is swapped out. Without commit(), nothing is left
/// behind, not even the parent folders that were made for it.
///
/// Whenever the process is killed or the power fails, there is the earlier run or the new one; what
/// is left over beside it goes with the next run of that name.
class RunFolder {
 public:
  /// Throws std::invalid_argument if the target is a file, is a folder that holds something other
  /// than an earlier run, or cannot be made. What is left beside it is looked for in `beside`, or
  /// where that is null in its parent folder.
  explicit RunFolder(const std::filesystem::path& target, const LeftBeside* beside = nullptr);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Where to write.
  const std::filesystem::path& path() const { return partial_; }
  const std::filesystem::path& target() const { return target_; }

  /// Puts the folder in its place. Throws OutputError if that fails: if the folder could not be
  /// written to the disk, it goes; if it is whole, it is kept under the name that the error says.
  void commit();

 private:
  std::filesystem::path keep();

  std::filesystem::path target_;
  std::filesystem::path partial_;
  std::vector<std::filesystem::path> made_parents_;  // innermost first
  bool is_done_ = false;                             // committed, or kept
};

/// Whether a folder is one that a run left, by its manifest.json.
bool is_run_folder(const std::filesystem::path& folder);

/// Whether a folder is what a run that is not done writes into, or one that was killed has left:
/// by its name.
bool is_unfinished_run(const std::filesystem::path& folder);

/// Why a folder must not be removed as a run that nobody wants, in one line; empty if it may be. It
/// holds only files that runs leave; one that is unfinished, of a process of this computer that is
/// no more.
std::string why_not_removable(const std::filesystem::path& folder);

/// Removes such a folder: killed at it, what is left of it is an unfinished run. Once no other
/// process finds it by its name, a finished one is looked at again: unless `may_go`, since by then
/// it is another run, it is put back. Returns whether it was removed. Throws OutputError.
bool remove_run(const std::filesystem::path& folder,
                const std::function<bool(const std::filesystem::path&)>& may_go);

/// For readers: where a process was killed while it replaced the run in `folder`, which is missing
/// now, the earlier run is put back. Every RunFolder does so.
void restore_run(const std::filesystem::path& folder);

/// Throws std::invalid_argument, one line, if the run's log.h5 is not what its manifest.json says.
/// Returns whether the manifest says anything: one of before 0.2 has no `log_hash`.
bool check_log(const std::filesystem::path& folder);

}  // namespace breakwater
