// A record of an axis: a table of times, inputs and positions.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace breakwater {

/// The largest Δ with which all differences between successive positions are whole counts, within
/// 5 % of a count. 0 if there is none, or if the position never moves.
///
/// The first guesses are the least difference, and the gaps between sorted differences. A line
/// through (count, position) removes the rounding of printed digits.
double encoder_quantum(std::span<const double> positions);

enum class InputActs { after, before };

/// The names of the table's columns, and the value of 1 in each. A scale of 1 takes the unit that
/// the table names, if any.
struct RecordFormat {
  std::string time_column = "time_s";
  std::string input_column = "u";
  std::string position_column = "y";
  double time_scale = 1.0;                  ///< s
  double input_scale = 1.0;                 ///< N m, or N
  double position_scale = 1.0;              ///< rad, or m
  InputActs input_acts = InputActs::after;  ///< the interval in which the input of a row acts
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

  /// Both as warnings about the file.
  std::vector<std::string> warnings(const std::string& file) const;
};

/// Reads a table of a laboratory (column_table.h). Repairs its columns time, input and position, in
/// the file's units, and counts it:
/// - rows without a time are left out
/// - rows out of order are sorted, if they are few and close to their place
/// - repeated rows are left out; stamps of a coarse clock are spread evenly
/// - a missing input is interpolated; an input of a lower rate is held
/// - rows without a position are left out; for a position of a lower rate, the inputs between two
///   positions become their mean
/// - a counter that wraps is unwrapped, and one that is reset to 0 goes on; a single position far
///   from both neighbours is left out
///
/// Throws std::invalid_argument as read_columns() does, and `FILE[:LINE]: reason` if the times
/// start again, a column has no number, or fewer than two rows are left.
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
