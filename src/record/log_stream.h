// The log of a run that is written to its file during the run.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/output_error.h>
#include <breakwater/record/track.h>

namespace breakwater {
namespace detail {
class DataFile;
}

/// Writes the rows of streamed tracks into log.h5 in the partial folder of a run.
///
/// The number of rows is known before the run. At the first row HDF5 therefore writes the headers
/// of all datasets with room for all rows, whose times are NaN. From then on the file is a log that
/// any reader of HDF5 opens. Later rows go to their places without HDF5. Twice a second the values
/// are synced to the disk, and then the times are written. So a row with a time is whole, even
/// after a power failure.
///
/// Only the first row allocates.
class LogStream {
 public:
  /// Writes config.toml, with `config_text`. `manifest` is the text of manifest.json until the run
  /// ends. Throws OutputError.
  LogStream(std::filesystem::path folder, const std::string& config_text, std::string manifest);
  /// Writes the rows so far, if that is possible.
  ~LogStream();
  LogStream(const LogStream&) = delete;
  LogStream& operator=(const LogStream&) = delete;

  /// Each streamed track calls this before the first row of any.
  void add(const Track& track) { tracks_.push_back(track); }
  /// Lays out the file, before the first row of any track. Throws OutputError.
  void begin();
  /// Writes what is full or due, after each row of a track. Throws OutputError.
  void write_full(const Track& track);

  /// Writes the rest of the log. `tracks` are those of the recording, streamed or not. Returns the
  /// complete log: log.h5, or another file of the folder that must get this name. It is another one
  /// if the run has fewer rows than expected. Throws OutputError.
  std::filesystem::path finish(const std::vector<Track>& tracks);

 private:
  using Clock = std::chrono::steady_clock;

  void write_values(const Track& track);
  void write_rows();

  std::filesystem::path folder_;
  std::string manifest_;
  std::vector<Track> tracks_;
  std::vector<LogEntry> datasets_;  // in the order of the file
  std::vector<std::uint64_t> places_;
  std::unique_ptr<detail::DataFile> log_;  // null before the first row
  Clock::time_point write_at_;
};

}  // namespace breakwater
