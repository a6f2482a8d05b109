// A log in memory: signals sampled on one time base.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <string>
#include <vector>

#include <breakwater/signals/signal.h>

namespace breakwater {

/// Of a log's datasets that number the values of vectors: "index_3" of those with three.
std::string index_name(std::size_t width);
bool is_index_name(const std::string& name);

/// There is no memory for the rows that were announced.
class LogTooLong : public std::bad_alloc {
 public:
  const char* what() const noexcept override {
    return "run.duration_s: the log of so long a run does not fit in memory";
  }
};

/// Copies a set of signals, row by row. Allocates in the constructor alone, if no more rows come
/// than were announced.
class Track {
 public:
  /// `name` names the time base ("control"). The signals' owners outlive the calls of append().
  /// Throws std::invalid_argument, one line, unless each signal has values and a name of its own
  /// that a log can hold: is_column_name(), not "time_s" nor "index_3". Throws LogTooLong.
  Track(std::string name, std::vector<Signal> signals, std::size_t expected_rows);

  void append(double time_s);

  const std::string& name() const { return name_; }
  std::size_t rows() const { return rows_.size() / width_; }
  std::size_t signals() const { return signals_.size(); }
  /// Name, unit, description and width of a signal; its values are no longer valid after the run.
  const Signal& signal(std::size_t i) const { return signals_[i]; }

  /// The times of all rows [s].
  std::vector<double> times() const;
  /// All rows of one signal, row-major: rows() × width.
  std::vector<double> values(std::size_t signal) const;
  /// All rows of the signal of that name. Throws std::out_of_range if there is none.
  std::vector<double> values(const std::string& signal) const;
  /// One row: the time, then every signal's values in order.
  std::span<const double> row(std::size_t i) const { return {&rows_[i * width_], width_}; }

 private:
  std::vector<double> columns(std::size_t first, std::size_t count) const;

  std::string name_;
  std::vector<Signal> signals_;
  std::vector<std::size_t> offsets_;  // of each signal in a row
  std::size_t width_ = 1;             // of a row
  std::vector<double> rows_;
};

}  // namespace breakwater
