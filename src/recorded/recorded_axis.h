// A record of an axis: a table of times, inputs and positions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// The names of the table's columns, and the value of 1 in each. A scale of 1 takes the unit that
/// the table names, if any.
struct RecordFormat {
  std::string time_column = "time_s";
  std::string input_column = "u";
  std::string position_column = "y";
  double time_scale = 1.0;      ///< s
  double input_scale = 1.0;     ///< N m, or N
  double position_scale = 1.0;  ///< rad, or m
};

/// The three columns, all with the same rows.
struct RecordedAxis {
  std::vector<double> times_s;  ///< increasing
  std::vector<double> inputs;
  std::vector<double> positions;
  /// All known inputs, also of rows without a position. Empty: those of the rows.
  std::vector<double> input_times_s;
  std::vector<double> all_inputs;
  std::vector<std::string> repairs;  ///< a line each, with the count and the first line of the file
  std::vector<std::string> doubts;   ///< signs of a forgotten scale
};

/// Reads a table of a laboratory (column_table.h) and repairs it (record_repair.h).
///
/// Throws std::invalid_argument as read_columns() and repaired() do.
RecordedAxis read_recorded_axis(const std::string& file, const RecordFormat& format = {});

/// The regularity of the sampling. Nothing is interpolated: an interval is a period or a gap.
struct RecordedTiming {
  double period_s = 0.0;          ///< as given, or the mean interval without the gaps
  std::vector<std::size_t> gaps;  ///< the row after each interval longer than `gap_periods`
  double jitter_rms_s = 0.0;      ///< deviation of the other intervals from the period
  double jitter_max_s = 0.0;      ///< the largest magnitude of this deviation
  std::size_t irregular = 0;      ///< number of intervals that deviate by more than `jitter_share`
};

/// `period_s` 0 takes the mean interval. The median interval then defines the gaps. `gap_periods`
/// and `jitter_share` are in periods.
RecordedTiming timing_of(const std::vector<double>& times_s, double period_s, double gap_periods,
                         double jitter_share);

}  // namespace breakwater
