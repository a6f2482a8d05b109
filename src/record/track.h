// A log: signals sampled on one time base.
#pragma once

#include <cstddef>
#include <memory>
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

/// Copies a set of signals row by row. Only the constructor allocates. Copies of a track share its
/// rows.
class Track {
 public:
  /// `name` is the name of the time base ("control"). The owners of the signals must outlive the
  /// calls of append(). With a `stream`, the rows go to its file and are not in memory. Throws
  /// std::invalid_argument, one line, unless each signal has values and a unique name that
  /// is_column_name(), other than "time_s" and "index_3". Throws LogTooLong.
  Track(std::string name, std::vector<Signal> signals, std::size_t room,
        LogStream* stream = nullptr);

  /// Throws std::logic_error if the track has room() rows, and OutputError if its stream cannot
  /// write.
  void append(double time_s);

  const std::string& name() const { return name_; }
  std::size_t rows() const { return rows_->written + rows_->untimed; }
  /// The most rows.
  std::size_t room() const { return room_; }
  std::size_t signals() const { return signals_.size(); }
  bool is_streamed() const { return stream_ != nullptr; }
  /// Name, unit, description and width of a signal. Its values are not valid after the run.
  const Signal& signal(std::size_t i) const { return signals_[i]; }

  // These need the rows in memory, so a streamed track does not have them.

  /// The times of all rows [s].
  std::span<const double> times() const { return {rows_->times.get(), rows()}; }
  /// All rows of one signal, row-major: rows() × width.
  std::span<const double> values(std::size_t signal) const;
  /// A copy of those of the signal with this name. Throws std::out_of_range if there is none.
  std::vector<double> values(const std::string& signal) const;

 private:
  friend class LogStream;

  // The rows that are not in the stream's file, and their numbers. The stream writes them even if
  // the track is gone.
  struct Rows {
    std::unique_ptr<double[]> times;   // one for each row without a time in the file
    std::unique_ptr<double[]> values;  // signal after signal, each with room for `capacity` rows
    std::size_t times_capacity;
    std::size_t capacity;
    std::size_t untimed = 0;        // rows without a time in the file
    std::size_t buffered = 0;       // rows in `values`
    std::size_t written = 0;        // rows with a time in the file
    std::size_t first_dataset = 0;  // the time base's number in the file
  };

  // The values of a signal in this row of the buffer.
  double* buffer(std::size_t signal, std::size_t row) const {
    return rows_->values.get() + offsets_[signal] * rows_->capacity +
           row * signals_[signal].values.size();
  }

  std::string name_;
  std::vector<Signal> signals_;
  std::vector<std::size_t> offsets_;  // places of the signals in a row, without the time
  std::size_t room_;
  LogStream* stream_;
  std::shared_ptr<Rows> rows_;
};

}  // namespace breakwater
