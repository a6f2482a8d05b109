// The log of a run that is written to its file during the run.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/record/hdf5_log.h>
#include <breakwater/record/output_error.h>
#include <breakwater/record/track.h>
#include <breakwater/signals/signal.h>

namespace breakwater {

/// Writes the rows of streamed tracks into log.h5 in the partial folder of a run.
///
/// The number of rows is known before the run. HDF5 therefore writes the headers of all datasets at
/// the first row, and then closes the file. Later rows go to their places without HDF5, so a kill
/// cannot damage the file. A journal lists the complete blocks. Rows are written after half a
/// second of simulated time or of the clock, whichever comes first. CutRun reads what a killed
/// process left.
///
/// Only the first row allocates.
class LogStream {
 public:
  /// Writes config.toml, with `config_text`. `manifest` is a JSON object with the entries of
  /// manifest.json that are known before the run. Throws OutputError.
  LogStream(std::filesystem::path folder, const std::string& config_text, std::string manifest);
  ~LogStream();
  LogStream(const LogStream&) = delete;
  LogStream& operator=(const LogStream&) = delete;

  /// Adds a track with room for `rows` rows, before the first row. Returns its number. The owners
  /// of the signals must outlive the calls of append().
  std::size_t add(std::string name, std::vector<Signal> signals, std::size_t rows);
  /// Copies a row of a track. Throws OutputError if a file cannot be written, and std::logic_error
  /// if the track is full.
  void append(std::size_t track, double time_s);

  /// Writes the rest of the log. `tracks` are those of the recording, streamed or not. Returns the
  /// complete log: log.h5, or another file of the folder that must get this name. It is another one
  /// if the run has fewer rows than expected. Throws OutputError.
  std::filesystem::path finish(const std::vector<Track>& tracks);

 private:
  struct Streamed;
  struct Files;
  using Clock = std::chrono::steady_clock;

  void begin();
  void announce();
  void flush();

  std::filesystem::path folder_;
  std::string manifest_;
  std::vector<Streamed> tracks_;
  std::vector<LogEntry> datasets_;  // in the order of the file
  std::vector<std::uint64_t> places_;
  std::unique_ptr<Files> files_;  // null before the first row
  double flush_at_s_ = 0.0;
  Clock::time_point flush_at_;
};

/// Removes the files that only CutRun needs from the folder of a finished run.
void forget_stream(const std::filesystem::path& folder);

/// Whether a process writes the streamed run in this folder.
bool is_being_written(const std::filesystem::path& folder);

}  // namespace breakwater
