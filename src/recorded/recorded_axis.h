// What a lab recorded of one axis: a table of times, inputs and positions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// How a table says it: what its columns are called, and what 1 in them is worth.
struct RecordFormat {
  std::string time_column = "time_s";
  std::string input_column = "u";
  std::string position_column = "y";
  double time_scale = 1.0;      ///< s
  double input_scale = 1.0;     ///< N m, or N
  double position_scale = 1.0;  ///< rad, or m
};

/// Row k of all three belongs together.
struct RecordedAxis {
  std::vector<double> times_s;  ///< rising
  std::vector<double> inputs;
  std::vector<double> positions;
};

/// Reads a table (column_table.h). Throws std::invalid_argument as read_columns() does, and if a
/// time is not later than the one before, or there are fewer than two rows.
RecordedAxis read_recorded_axis(const std::string& file, const RecordFormat& format = {});

/// How regularly it was sampled. Nothing is interpolated: an interval is a period, or a gap.
struct RecordedTiming {
  double period_s = 0.0;          ///< given, or the mean interval without the gaps
  std::vector<std::size_t> gaps;  ///< rows behind an interval longer than `gap_periods`
  double jitter_rms_s = 0.0;      ///< of the intervals that are no gaps, from the period
  double jitter_max_s = 0.0;      ///< the largest of them, by amount
  std::size_t irregular = 0;      ///< how many are off by more than `jitter_share`
};

/// `period_s` 0: the mean interval, where gaps are those of the median; `gap_periods` and
/// `jitter_share` are in periods.
RecordedTiming timing_of(const std::vector<double>& times_s, double period_s, double gap_periods,
                         double jitter_share);

}  // namespace breakwater
