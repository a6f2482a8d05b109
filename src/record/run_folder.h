// The folder of a run: complete or absent.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <breakwater/record/output_error.h>

namespace breakwater {
namespace detail {
class DataFile;
}

/// A file in a partial folder that no other run may remove. Its log is streamed (LogStream), or it
/// is a complete run that could not be moved elsewhere.
inline constexpr const char* kKept = "kept";

/// The hidden names in a folder: processes may have left them beside its runs. One list serves many
/// runs: a new one for each would take quadratic time.
std::set<std::string> hidden_names_in(const std::filesystem::path& folder);

/// Files are written into a partial folder beside the target, or beside the folder that a symbolic
/// link names. commit() renames it when it is complete and on the disk, and removes an earlier run.
/// Without commit(), nothing is left, not even parent folders that were made for it.
///
/// After a kill or a power failure, the earlier run or the new one is there. The next run removes
/// the rest. A partial folder with kKept always stays.
class RunFolder {
 public:
  /// Throws std::invalid_argument if the target is a file, holds something other than an earlier
  /// run, or cannot be made. `beside` has the hidden_names_in() the parent folder; if null, this is
  /// read.
  explicit RunFolder(const std::filesystem::path& target,
                     const std::set<std::string>* beside = nullptr);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// The partial folder, in which to write.
  const std::filesystem::path& path() const { return partial_; }
  const std::filesystem::path& target() const { return target_; }

  /// Moves the folder to its target. Throws OutputError if that fails. If the data could not be
  /// written to the disk, the folder is removed. A complete one is kept; the error names it.
  void commit();

 private:
  std::filesystem::path keep();

  std::filesystem::path target_;
  std::filesystem::path partial_;
  std::filesystem::path written_;                    // no other thread may write these
  std::unique_ptr<detail::DataFile> lock_;           // on the partial folder
  std::vector<std::filesystem::path> made_parents_;  // innermost first
  bool is_done_ = false;                             // committed or kept
};

/// Whether a folder holds a finished run, by its manifest.json.
bool is_run_folder(const std::filesystem::path& folder);

/// Whether a folder is a partial one that only the user removes: it has kKept.
bool is_kept(const std::filesystem::path& folder);

/// Whether a process writes the run in this partial folder.
bool is_being_written(const std::filesystem::path& folder);

/// Whether a folder is the partial folder of an unfinished or killed run, by its name.
bool is_unfinished_run(const std::filesystem::path& folder);

/// Calls `read` again if another run has replaced the folder meanwhile, so that all files belong to
/// one run. Passes on its std::invalid_argument. If a process was killed while it replaced the
/// folder, it restores the earlier run first.
void read_whole(const std::filesystem::path& folder, const std::function<void()>& read);

/// Throws std::invalid_argument, one line, if a file of a run differs from its hash in
/// manifest.json. Returns whether the manifest has one: `config_hash` of config.toml. Versions
/// before 0.2 wrote none, and 0.2 only `log_hash`.
bool check_file(const std::filesystem::path& folder, const char* file);
/// Throws std::invalid_argument, one line, if a run has no config.toml or log.h5, or an empty one.
void check_has_files(const std::filesystem::path& folder);

}  // namespace breakwater
