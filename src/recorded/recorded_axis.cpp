#include <breakwater/recorded/recorded_axis.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/config/column_table.h>
#include <breakwater/statistics/quantile.h>

namespace breakwater {

RecordedAxis read_recorded_axis(const std::string& file, const RecordFormat& format) {
  ColumnTable table = read_columns(file, {{format.time_column, "csv.time_column"},
                                          {format.input_column, "csv.input_column"},
                                          {format.position_column, "csv.position_column"}});
  const auto scaled = [](std::vector<double>& values, double scale) {
    for (double& value : values) value *= scale;
    return std::move(values);
  };
  RecordedAxis axis{scaled(table.columns[0], format.time_scale),
                    scaled(table.columns[1], format.input_scale),
                    scaled(table.columns[2], format.position_scale)};
  check_rising(file, table, axis.times_s,
               format.time_column + ": must be later than in the row before");
  if (table.rows() < 2) throw std::invalid_argument(file + ": has fewer than two rows");
  return axis;
}

RecordedTiming timing_of(const std::vector<double>& times_s, double period_s, double gap_periods,
                         double jitter_share) {
  std::vector<double> intervals(times_s.size() - 1);
  for (std::size_t k = 0; k < intervals.size(); ++k) intervals[k] = times_s[k + 1] - times_s[k];
  RecordedTiming timing;
  timing.period_s = period_s;
  if (period_s == 0.0) {
    // Use the mean of the intervals that are no gaps by the median: jitter cancels in it.
    std::vector<double> in_any_order = intervals;
    const double median = sample_median(in_any_order);
    double sum = 0.0;
    double count = 0.0;
    for (const double interval : intervals) {
      if (interval > gap_periods * median) continue;
      sum += interval;
      count += 1.0;
    }
    timing.period_s = sum / count;
  }
  double squares = 0.0;
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    if (intervals[k] > gap_periods * timing.period_s) {
      timing.gaps.push_back(k + 1);
      continue;
    }
    const double off = std::abs(intervals[k] - timing.period_s);
    squares += off * off;
    timing.jitter_max_s = std::max(timing.jitter_max_s, off);
    if (off > jitter_share * timing.period_s) ++timing.irregular;
  }
  const std::size_t regular = intervals.size() - timing.gaps.size();
  if (regular > 0) timing.jitter_rms_s = std::sqrt(squares / static_cast<double>(regular));
  return timing;
}

}  // namespace breakwater
