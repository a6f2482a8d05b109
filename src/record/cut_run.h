// Recovery of the log that a killed process left.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/output_error.h>
#include <breakwater/record/streamed_files.h>

namespace breakwater {

/// A partial folder with the log of a run up to the last rows that its journal lists.
class CutRun {
 public:
  /// Locks the run, and checks the rows. Throws std::invalid_argument, one line, if the folder
  /// holds no such run, a process still writes it, or it has no complete rows. Throws OutputError
  /// if a file cannot be opened.
  explicit CutRun(const std::filesystem::path& folder);

  /// The entries of manifest.json that were known before the run, as a JSON object.
  const std::string& manifest() const { return manifest_; }
  /// The last time in the log [s].
  double end_s() const { return end_s_; }
  /// Whether rows were left out, since they are not what the journal says.
  bool is_damaged() const { return is_damaged_; }

  /// Writes a log of the complete rows. Throws OutputError.
  void write_log(const std::filesystem::path& file) const;

 private:
  struct Dataset {
    LogEntry entry;  // with the number of complete rows
    std::size_t room = 0;
    std::uint64_t place = 0;
    std::uint32_t track = 0;
  };

  void read_running(const std::filesystem::path& file, const std::filesystem::path& log);
  void read_journal(const std::filesystem::path& file);
  bool holds(const detail::JournalEntry& block) const;

  detail::DataFile running_;
  detail::DataFile log_;
  std::string manifest_;
  std::vector<Dataset> datasets_;
  double end_s_ = 0.0;
  bool is_damaged_ = false;
};

}  // namespace breakwater
