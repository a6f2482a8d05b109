// log.h5: a run's tracks as HDF5.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <breakwater/record/output_error.h>
#include <breakwater/record/track.h>

namespace breakwater {

/// Writes one group per track, with the time base `time_s` and one dataset per signal: N, or
/// N×width for a vector. Each dataset has the attributes `unit`, `units` (the same) and
/// `description`, in UTF-8 of fixed length.
///
/// `deflate_level` 0 writes plain data; 1 to 9 compress it. Throws OutputError if the file
/// cannot be written. Thread-safe.
void write_hdf5_log(const std::string& file, const std::vector<Track>& tracks, int deflate_level);

/// The library's version, "1.10.8".
std::string hdf5_version();

/// A dataset of a log: rows × width values, row-major.
struct LoggedSignal {
  std::size_t rows = 0;
  std::size_t width = 0;
  std::vector<double> values;

  const double* row(std::size_t i) const { return &values[i * width]; }
};

/// "force_N", or "force_N[3]" for the third of its values.
struct SignalName {
  std::string name;
  std::size_t index = 0;  ///< 0: not given
};
/// Throws std::invalid_argument if it is neither.
SignalName signal_name(const std::string& text);

/// A dataset of a log: its group, name and unit.
struct LogEntry {
  std::string group;  ///< the track: "control"
  std::string name;   ///< the signal; time bases are not listed
  std::string unit;   ///< for all values, or for each one: "m, m, rad"
  std::string description;
  std::size_t rows = 0;
  std::size_t width = 0;

  /// The unit of one value, counted from 1.
  std::string unit_of(std::size_t index) const;
};

/// The datasets of a track with this many rows: the time base, then its signals.
std::vector<LogEntry> datasets_of(const Track& track, std::size_t rows);

/// Writes a log with room for the values of `datasets`, each track's by datasets_of(). Returns the
/// place of each first value in the file [bytes]; a dataset without rows has place 0. With all
/// values at their places, row-major, the file has the bytes of write_hdf5_log() without
/// compression. Throws OutputError. Thread-safe.
std::vector<std::uint64_t> lay_out_hdf5_log(const std::string& file,
                                            const std::vector<LogEntry>& datasets);

/// The readers check types, sizes and that the data are in the file. They do not follow links, and
/// read texts of variable length (version 0.1) as empty. A damaged file may still be misread or
/// crash HDF5, so call check_file() first. Without a hash, call check_foreign_log().

/// All signals of a log, by group and name. Throws std::invalid_argument if it is no log.
/// Thread-safe.
std::vector<LogEntry> list_hdf5_signals(const std::string& file);

/// Reads one dataset, "control/qpos" for example, up to `most_rows` rows. Throws
/// std::invalid_argument if the file is no log or has no such dataset. Thread-safe.
LoggedSignal read_hdf5_signal(const std::string& file, const std::string& dataset,
                              std::size_t most_rows = SIZE_MAX);

/// The number of rows that a run has written into a track whose later times are NaN. Throws
/// std::invalid_argument if the file is no log or has no such track. Thread-safe.
std::size_t written_rows(const std::string& file, const std::string& track);

/// Reads a log of unknown origin in a child process; only its headers without `has_values`. HDF5
/// never ends on some files, and crashes on others. Throws std::invalid_argument if it is not a
/// log, or the child fails. Throws OutputError if there is no room for a child. The child ends with
/// the call. Thread-safe.
void check_foreign_log(const std::string& file, bool has_values);

}  // namespace breakwater
