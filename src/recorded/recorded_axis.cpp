#include <breakwater/recorded/recorded_axis.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include <breakwater/config/column_table.h>
#include <breakwater/recorded/record_repair.h>
#include <breakwater/statistics/quantile.h>

namespace breakwater {

namespace {

constexpr double kSlow = 0.1;         // s: an interval from which the times look like milliseconds
constexpr double kFewCounts = 100.0;  // the least range of positions that look like counts

// Scales that the user may have forgotten.
std::vector<std::string> doubts_of(const RecordedAxis& axis, bool has_position_scale) {
  std::vector<std::string> doubts;
  std::vector<double> intervals;
  for (std::size_t k = 1; k < axis.times_s.size(); ++k) {
    intervals.push_back(axis.times_s[k] - axis.times_s[k - 1]);
  }
  const double interval_s = sample_median(intervals);
  if (interval_s >= kSlow) {
    doubts.push_back(
        fmt::format("the rows are {:.3g} s apart. If the times are milliseconds, set "
                    "csv.time_scale=1e-3",
                    interval_s));
  }
  const auto [low, high] = std::minmax_element(axis.positions.begin(), axis.positions.end());
  const bool is_whole = std::all_of(axis.positions.begin(), axis.positions.end(),
                                    [](double y) { return y == std::round(y); });
  if (!has_position_scale && is_whole && *high - *low >= kFewCounts) {
    doubts.emplace_back(
        "all positions are whole numbers. If they are counts, set csv.position_scale to one count "
        "in rad or m");
  }
  return doubts;
}

// Very large or very small numbers may lose this by a repair or a scale.
void check_finite(const std::string& file, const RecordedAxis& axis) {
  for (const auto* values : {&axis.times_s, &axis.inputs, &axis.positions, &axis.all_inputs}) {
    if (!std::all_of(values->begin(), values->end(), [](double x) { return std::isfinite(x); })) {
      throw std::invalid_argument(file + ": has a number that is too large in SI units");
    }
  }
  for (const auto* times_s : {&axis.times_s, &axis.input_times_s}) {
    if (std::adjacent_find(times_s->begin(), times_s->end(), std::greater_equal<>()) !=
        times_s->end()) {
      throw std::invalid_argument(file + ": two times are the same number of seconds");
    }
  }
}

}  // namespace

RecordedAxis read_recorded_axis(const std::string& file, const RecordFormat& format) {
  ColumnTable table = read_columns(file,
                                   {{format.time_column, "csv.time_column"},
                                    {format.input_column, "csv.input_column"},
                                    {format.position_column, "csv.position_column"}},
                                   TableKind::laboratory);
  RecordedAxis axis = repaired(file, table, format.time_column);
  const auto multiply = [](std::vector<double>& values, double scale) {
    for (double& value : values) value *= scale;
  };
  const double scales[] = {format.time_scale, format.input_scale, format.position_scale};
  std::vector<double>* const columns[] = {&axis.times_s, &axis.inputs, &axis.positions};
  bool has_position_scale = false;
  for (std::size_t i = 0; i < 3; ++i) {
    double scale = scales[i];
    const std::string& unit = table.units[i];
    if (scale == 1.0 && unit_in_si(unit).value_or(1.0) != 1.0) {
      scale = *unit_in_si(unit);
      axis.repairs.push_back(
          fmt::format("the unit {} of the first lines: 1 is {:.6g} in SI units", unit, scale));
    }
    multiply(*columns[i], scale);
    if (i == 2) has_position_scale = scale != 1.0;
    if (i == 0) multiply(axis.input_times_s, scale);
    if (i == 1) multiply(axis.all_inputs, scale);
  }
  check_finite(file, axis);
  axis.doubts = doubts_of(axis, has_position_scale);
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
  // Stamps that are exact but for their last digit have no jitter.
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  const double largest_s = std::max(std::abs(times_s.front()), std::abs(times_s.back()));
  double squares = 0.0;
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    if (intervals[k] > gap_periods * timing.period_s) {
      timing.gaps.push_back(k + 1);
      continue;
    }
    const double off = std::abs(intervals[k] - timing.period_s);
    if (off <= kRounding * largest_s) continue;
    squares += off * off;
    timing.jitter_max_s = std::max(timing.jitter_max_s, off);
    if (off > jitter_share * timing.period_s) ++timing.irregular;
  }
  const std::size_t regular = intervals.size() - timing.gaps.size();
  if (regular > 0) timing.jitter_rms_s = std::sqrt(squares / static_cast<double>(regular));
  return timing;
}

}  // namespace breakwater
