// log.h5: a run's tracks as HDF5.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/record/output_error.h>
#include <breakwater/record/track.h>

namespace breakwater {

/// Writes one group per track, named as the track, with its time base `time_s` and one dataset per
/// signal: N, or N×width for a vector. Each dataset has the attributes `unit`, the same again as
/// `units`, and `description`, UTF-8 of fixed length. The time base is attached as the scale of its
/// first dimension, `index_WIDTH` (1 … width) as that of a vector's second one, so that readers of
/// netCDF find coordinates.
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

/// What a log says about one of its datasets.
struct LogEntry {
  std::string group;  ///< the track: "control"
  std::string name;   ///< of the signal; time bases are left out
  std::string unit;   ///< of all values, or each one's: "m, m, rad"
  std::string description;
  std::size_t rows = 0;
  std::size_t width = 0;

  /// Of one value, counted from 1.
  std::string unit_of(std::size_t index) const;
};

/// What these read is checked first: types, sizes, that the data are in the file. Links are not
/// followed, texts of variable length (as version 0.1 wrote them) are taken as empty. A damaged
/// file may still be misread, or crash HDF5 itself: check_log() comes first, and a log of which the
/// manifest says nothing is read by read_foreign_log().

/// All signals of a log, by group and name. Throws std::invalid_argument if the file is no log.
/// Thread-safe.
std::vector<LogEntry> list_hdf5_signals(const std::string& file);

/// Reads one dataset, "control/qpos" for example. Throws std::invalid_argument if the file is no
/// log or has no such dataset. Thread-safe.
LoggedSignal read_hdf5_signal(const std::string& file, const std::string& dataset);

/// All of a log.
struct LogContents {
  std::vector<LogEntry> signals;
  std::map<std::string, LoggedSignal> datasets;  ///< by "GROUP/NAME", time bases too
};

/// Reads all of a log that anybody may have written, in a child process: on some files HDF5 crashes
/// or never ends. Throws std::invalid_argument if it is no log, has more than 1 GB of values, or
/// the child did not read it; Interrupted if a signal comes that this process handles. The child
/// ends then, and with this process. Thread-safe.
LogContents read_foreign_log(const std::string& file);

}  // namespace breakwater
