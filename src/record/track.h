// A log in memory: signals sampled on one time base.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <string>
#include <vector>

#include <breakwater/signals/signal.h>

namespace breakwater {

/// Whether version 0.2 wrote a dataset of this name, with the numbers of a vector's values:
/// "index_3".
bool is_index_name(const std::string& name);

/// The expected rows do not fit in memory.
class LogTooLong : public std::bad_alloc {
 public:
  const char* what() const noexcept override {
    return "run.duration_s: the log of so long a run does not fit in memory: set "
           "record.stream=true";
  }
};

class LogStream;

/// Copies a set of signals row by row. Only the constructor allocates, unless there are too many
/// rows.
class Track {
 public:
  /// `name` is the name of the time base ("control"). The owners of the signals must outlive the
  /// calls of append(). With a `stream`, the rows go to its file and are not in memory. Throws
  /// std::invalid_argument, one line, unless each signal has values and a unique name that
  /// is_column_name(), other than "time_s" and "index_3". Throws LogTooLong.
  Track(std::string name, std::vector<Signal> signals, std::size_t expected_rows,
        LogStream* stream = nullptr);

  void append(double time_s);

  const std::string& name() const { return name_; }
  std::size_t rows() const { return row_count_; }
  std::size_t signals() const { return signals_.size(); }
  bool is_streamed() const { return stream_ != nullptr; }
  /// Name, unit, description and width of a signal. Its values are not valid after the run.
  const Signal& signal(std::size_t i) const { return signals_[i]; }

  const std::vector<Signal>& all_signals() const { return signals_; }

  // These need the rows in memory, so a streamed track does not have them.

  /// The times of all rows [s].
  std::vector<double> times() const;
  /// All rows of one signal, row-major: rows() × width.
  std::vector<double> values(std::size_t signal) const;
  /// All rows of the signal with this name. Throws std::out_of_range if there is none.
  std::vector<double> values(const std::string& signal) const;
  /// One row: the time, then every signal's values in order.
  std::span<const double> row(std::size_t i) const { return {&rows_[i * width_], width_}; }

 private:
  std::vector<double> columns(std::size_t first, std::size_t count) const;

  std::string name_;
  std::vector<Signal> signals_;
  std::vector<std::size_t> offsets_;  // places of the signals in a row
  std::size_t width_ = 1;             // values in a row
  std::size_t row_count_ = 0;
  std::vector<double> rows_;
  LogStream* stream_;
  std::size_t place_ = 0;  // number of the track in the stream
};

}  // namespace breakwater
