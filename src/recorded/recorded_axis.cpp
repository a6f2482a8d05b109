#include <breakwater/recorded/recorded_axis.h>

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/statistics/linear_regression.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include <breakwater/config/column_table.h>
#include <breakwater/shell/table.h>
#include <breakwater/statistics/distribution.h>

namespace breakwater {
namespace {

constexpr double kLoose = 0.2;   // in counts, while the first guess is refined
constexpr double kTight = 0.05;  // in counts, at the end

// Whether the sorted differences are multiples of about `quantum`, which they then refine.
bool explains(const std::vector<double>& differences, double& quantum) {
  double products = 0.0;
  double squares = 0.0;
  for (const double d : differences) {
    const double n = std::round(d / quantum);
    if (n < 1.0 || std::abs(d - n * quantum) > kLoose * quantum) return false;
    products += n * d;
    squares += n * n;
    quantum = products / squares;
  }
  return std::all_of(differences.begin(), differences.end(), [&](double d) {
    return std::abs(d - std::round(d / quantum) * quantum) <= kTight * quantum;
  });
}

// Guesses of a count, the largest first: gaps between the sorted differences, and the least one.
std::vector<double> guesses_of(const std::vector<double>& differences) {
  std::vector<double> guesses = {differences.front()};
  for (std::size_t k = 1; k < differences.size(); ++k) {
    const double gap = differences[k] - differences[k - 1];
    if (gap > 0.0 && gap < guesses.front()) guesses.push_back(gap);
  }
  std::sort(guesses.begin(), guesses.end(), std::greater<>());
  // Digits that are rounded make the same gap several times.
  guesses.erase(
      std::unique(guesses.begin(), guesses.end(), [](double a, double b) { return b > 0.999 * a; }),
      guesses.end());
  return guesses;
}

constexpr double kManyRows = 0.2;           // share from which a damage is a property of the record
constexpr std::size_t kFarthestRows = 100;  // that a row may be out of its place
constexpr std::size_t kRowsBeforeWraps = 20;  // a shorter table shows no wrapped counter
constexpr double kJump = 20.0;                // least size of a wrap, in large normal steps
constexpr std::size_t kWrapsForAnyRange = 3;  // from which the range need not be a common one

struct Row {
  double time, input, position;
  std::size_t line;
};

using Lines = std::vector<std::size_t>;  // where the repaired rows are in the file

class Repair {
 public:
  Repair(const std::string& file, const ColumnTable& table, const std::string& time_column)
      : file_(file), time_column_(time_column) {
    Lines without_time;
    for (std::size_t k = 0; k < table.rows(); ++k) {
      const Row row{table.columns[0][k], table.columns[1][k], table.columns[2][k], table.lines[k]};
      if (std::isnan(row.time)) {
        without_time.push_back(row.line);
      } else {
        rows_.push_back(row);
      }
    }
    if (table.has_torn_end) repairs_.emplace_back("the last line is not whole and was left out");
    report(without_time, "row", "without a time left out");
  }

  RecordedAxis result() {
    require_rows();
    sort();
    treat_repeated_times();
    require_rows();
    fill_inputs();
    const std::vector<Row> with_inputs = rows_;
    take_positions();
    require_rows();
    unwrap();
    RecordedAxis axis;
    for (const Row& row : with_inputs) {
      axis.input_times_s.push_back(row.time);
      axis.all_inputs.push_back(row.input);
    }
    for (const Row& row : rows_) {
      axis.times_s.push_back(row.time);
      axis.inputs.push_back(row.input);
      axis.positions.push_back(row.position);
    }
    axis.repairs = std::move(repairs_);
    return axis;
  }

 private:
  // Adds "3 rows WHAT (the first in line 7)".
  void report(const Lines& lines, const std::string& thing, const std::string& what) {
    if (lines.empty()) return;
    repairs_.push_back(fmt::format("{} {} ({} line {})", number_of(lines.size(), thing), what,
                                   lines.size() == 1 ? "in" : "the first in", lines.front()));
  }

  void require_rows() const {
    if (rows_.size() < 2) {
      throw std::invalid_argument(file_ + ": has fewer than two rows with different times");
    }
  }

  bool is_many(std::size_t count) const {
    return static_cast<double>(count) > kManyRows * static_cast<double>(rows_.size());
  }

  void sort() {
    const std::size_t farthest = std::clamp<std::size_t>(rows_.size() / 10, 1, kFarthestRows);
    Lines late;
    double latest = rows_.front().time;
    for (const Row& row : rows_) {
      if (row.time < latest) late.push_back(row.line);
      latest = std::max(latest, row.time);
    }
    if (late.empty()) return;
    std::vector<std::size_t> order(rows_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
      return rows_[a].time < rows_[b].time;
    });
    std::vector<Row> sorted;
    for (std::size_t k = 0; k < order.size(); ++k) {
      sorted.push_back(rows_[order[k]]);
      // A row that came too late moves forward.
      if (order[k] > k + farthest) {
        fail_at_line(file_, rows_[order[k]].line,
                     fmt::format("{}: goes back by more than {}: is this a second record?",
                                 time_column_, number_of(farthest, "row")));
      }
    }
    rows_ = std::move(sorted);
    report(late, "row", "out of order sorted");
  }

  void treat_repeated_times() {
    Lines repeated;
    std::size_t same = 0;
    for (std::size_t k = 1; k < rows_.size(); ++k) {
      if (rows_[k].time > rows_[k - 1].time) continue;
      repeated.push_back(rows_[k].line);
      if (rows_[k].input == rows_[k - 1].input && rows_[k].position == rows_[k - 1].position) {
        ++same;
      }
    }
    if (repeated.empty()) return;
    // Rows that are written twice have the same values, too.
    if (is_many(repeated.size()) && 10 * same < 9 * repeated.size() &&
        rows_.back().time > rows_.front().time) {
      spread();
      report(repeated, "time", "of a coarse clock spread evenly");
      return;
    }
    rows_.erase(std::unique(rows_.begin(), rows_.end(),
                            [](const Row& a, const Row& b) { return b.time <= a.time; }),
                rows_.end());
    report(repeated, "row", "with a repeated time left out");
  }

  // The rows of one stamp share the time until the next stamp.
  void spread() {
    double length = 0.0;
    std::size_t before = 1;
    for (std::size_t from = 0; from < rows_.size();) {
      std::size_t to = from + 1;
      while (to < rows_.size() && rows_[to].time == rows_[from].time) ++to;
      const auto n = static_cast<double>(to - from);
      // The last stamp has no next one.
      length = to < rows_.size() ? rows_[to].time - rows_[from].time
                                 : length / static_cast<double>(before) * n;
      before = to - from;
      for (std::size_t i = 1; i < before; ++i) {
        rows_[from + i].time += length * static_cast<double>(i) / n;
      }
      from = to;
    }
  }

  Lines lines_without(double Row::*number, const char* name) const {
    Lines lines;
    for (const Row& row : rows_) {
      if (std::isnan(row.*number)) lines.push_back(row.line);
    }
    if (lines.size() < rows_.size()) return lines;
    throw std::invalid_argument(file_ + ": no row has " + name);
  }

  void fill_inputs() {
    const Lines missing = lines_without(&Row::input, "an input");
    if (missing.empty()) return;
    const bool is_held = is_many(missing.size());
    std::size_t next = 0;  // the next row with an input
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (!std::isnan(rows_[k].input)) continue;
      next = std::max(next, k);
      while (next < rows_.size() && std::isnan(rows_[next].input)) ++next;
      if (k == 0) {
        rows_[k].input = rows_[next].input;
      } else if (is_held || next == rows_.size()) {
        rows_[k].input = rows_[k - 1].input;
      } else {
        const double share =
            (rows_[k].time - rows_[k - 1].time) / (rows_[next].time - rows_[k - 1].time);
        rows_[k].input = rows_[k - 1].input + share * (rows_[next].input - rows_[k - 1].input);
      }
    }
    report(
        missing, "input",
        is_held ? "missing: the input has a lower rate and was held" : "missing and interpolated");
  }

  void take_positions() {
    const Lines missing = lines_without(&Row::position, "a position");
    if (missing.empty()) return;
    const bool is_rate = is_many(missing.size());
    std::vector<Row> kept;
    for (std::size_t k = 0; k < rows_.size();) {
      std::size_t next = k + 1;
      while (next < rows_.size() && std::isnan(rows_[next].position)) ++next;
      if (!std::isnan(rows_[k].position)) {
        kept.push_back(rows_[k]);
        if (is_rate && next < rows_.size()) kept.back().input = mean_input(k, next);
      }
      k = next;
    }
    rows_ = std::move(kept);
    report(missing, "row",
           is_rate ? "without a position left out: the position has a lower rate, and the "
                     "input became its mean"
                   : "without a position left out");
  }

  // The mean of the held inputs from row `from` to row `to`.
  double mean_input(std::size_t from, std::size_t to) const {
    double sum = 0.0;
    for (std::size_t k = from; k < to; ++k) {
      sum += rows_[k].input * (rows_[k + 1].time - rows_[k].time);
    }
    return sum / (rows_[to].time - rows_[from].time);
  }

  double step(std::size_t k) const { return rows_[k].position - rows_[k - 1].position; }

  bool is_jump(std::size_t k) const { return std::binary_search(jumps_.begin(), jumps_.end(), k); }

  // The step at row k by the motion beside it.
  double motion(std::size_t k) const {
    double sum = 0.0;
    double count = 0.0;
    for (const std::size_t i : {k - 1, k + 1}) {
      if (i < 1 || i >= rows_.size() || is_jump(i)) continue;
      sum += step(i);
      count += 1.0;
    }
    return count > 0.0 ? sum / count : 0.0;
  }

  // Far above the steps beside it and the normal ones.
  bool is_isolated(std::size_t k, double normal) const {
    double most = normal;
    for (const std::size_t i : {k - 1, k + 1}) {
      if (i >= 1 && i < rows_.size()) most = std::max(most, std::abs(step(i)));
    }
    return std::abs(step(k)) > kJump * most;
  }

  // If all jumps go to 0, the counter was reset. The motion goes on by the step before.
  void continue_after_resets(double normal) {
    for (const std::size_t k : jumps_) {
      if (std::abs(rows_[k].position) > std::max(normal, std::abs(motion(k)))) return;
    }
    Lines resets;
    double missing = 0.0;
    for (std::size_t k = 1; k < rows_.size(); ++k) {
      if (is_jump(k)) {
        const double last = k > 1 ? step(k - 1) : 0.0;
        missing = rows_[k - 1].position + last - rows_[k].position;
        resets.push_back(rows_[k].line);
      }
      rows_[k].position += missing;
    }
    report(resets, "reset", "of the counter to 0 undone");
  }

  // A counter that wraps jumps by its range, whenever it leaves it. One that is reset jumps to 0
  // from anywhere.
  void unwrap() {
    if (rows_.size() < kRowsBeforeWraps) return;
    std::vector<double> steps;
    double low = rows_.front().position;
    double high = low;
    for (std::size_t k = 1; k < rows_.size(); ++k) {
      if (step(k) != 0.0) steps.push_back(std::abs(step(k)));
      low = std::min(low, rows_[k].position);
      high = std::max(high, rows_[k].position);
    }
    if (steps.empty()) return;
    std::sort(steps.begin(), steps.end());
    // A position that is held for some rows stands in most of them.
    const double normal = quantile(steps, steps.size() < kRowsBeforeWraps ? 0.5 : 0.9);
    std::size_t far = 0;  // jumps of more than half the range of the column
    for (std::size_t k = 1; k < rows_.size(); ++k) {
      const bool is_far = std::abs(step(k)) > std::max(0.5 * (high - low), kJump * normal);
      far += is_far ? 1 : 0;
      if (is_far || is_isolated(k, normal)) jumps_.push_back(k);
    }
    if (jumps_.empty()) return;
    std::vector<double> sizes;
    for (const std::size_t k : jumps_) sizes.push_back(std::abs(step(k) - motion(k)));
    const double median = sample_median(sizes);
    const double tolerance = std::max(2.0 * wobble(), 1e-6 * median);
    const double range = counter_range(median, tolerance);
    if (range == 0.0 && leave_out_spikes()) return;
    double wrap = range;
    if (wrap == 0.0 && jumps_.size() >= kWrapsForAnyRange) {
      std::vector<double> positions;
      for (const Row& row : rows_) positions.push_back(row.position);
      const double quantum = encoder_quantum(positions);
      wrap = quantum > 0.0 ? quantum * std::round(median / quantum) : median;
    }
    // Two positions of a counter differ by less than its range, and by the range itself if both
    // ends are rounded. Then the motion passes them.
    const double widest = range > 0.0 ? wrap * (1.0 + 1e-9) : wrap + tolerance;
    const bool has_ends = high - low >= wrap * (1.0 - 1e-9);
    const bool is_wrap =
        wrap > 0.0 && far == jumps_.size() && high - low <= widest &&
        std::all_of(sizes.begin(), sizes.end(),
                    [&](double size) { return std::abs(size - median) <= tolerance; }) &&
        (!has_ends || std::all_of(jumps_.begin(), jumps_.end(),
                                  [&](std::size_t k) { return motion(k) * step(k) < 0.0; }));
    if (!is_wrap) return continue_after_resets(normal);
    Lines wraps;
    double turns = 0.0;
    std::vector<double> signs(rows_.size(), 0.0);
    for (const std::size_t k : jumps_) {
      signs[k] = step(k) > 0.0 ? -1.0 : 1.0;
      wraps.push_back(rows_[k].line);
    }
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      turns += signs[k];
      rows_[k].position += turns * wrap;
    }
    report(wraps, "wrap", fmt::format("of a counter of {:.10g} unwrapped", wrap));
  }

  // How far steps are from the motion beside them, of all but the jumps.
  double wobble() const {
    std::vector<double> off;
    for (std::size_t k = 1; k < rows_.size(); ++k) {
      if (!is_jump(k)) off.push_back(std::abs(step(k) - motion(k)));
    }
    std::sort(off.begin(), off.end());
    return quantile(off, 0.99);
  }

  // A power of two, a turn in a common unit, or a round number of counts; 0 if none is near.
  static double counter_range(double size, double tolerance) {
    std::vector<double> ranges = {1.0, 2.0 * std::numbers::pi, std::numbers::pi, 180.0, 360.0};
    for (int bits = 8; bits <= 32; ++bits) ranges.push_back(std::ldexp(1.0, bits));
    for (const double decade : {1e2, 1e3, 1e4, 1e5, 1e6}) {
      for (const double factor : {1.0, 2.0, 4.0, 5.0, 8.0}) ranges.push_back(factor * decade);
    }
    double best = 0.0;
    for (const double range : ranges) {
      const double off = std::abs(range - size);
      if (off <= std::min(tolerance, 0.02 * range) && (best == 0.0 || off < std::abs(best - size)))
        best = range;
    }
    return best;
  }

  // Whether all jumps are pairs there and back at the same row, which is then left out.
  bool leave_out_spikes() {
    if (jumps_.size() % 2 != 0) return false;
    for (std::size_t i = 0; i < jumps_.size(); i += 2) {
      const bool is_pair =
          jumps_[i + 1] == jumps_[i] + 1 && step(jumps_[i]) * step(jumps_[i + 1]) < 0.0;
      if (!is_pair) return false;
    }
    Lines wrong;
    for (std::size_t i = 0; i < jumps_.size(); i += 2) wrong.push_back(rows_[jumps_[i]].line);
    for (std::size_t i = jumps_.size(); i >= 2; i -= 2) {
      rows_.erase(rows_.begin() + static_cast<std::ptrdiff_t>(jumps_[i - 2]));
    }
    report(wrong, "row", "with a position far from both neighbours left out");
    return true;
  }

  const std::string& file_;
  const std::string& time_column_;
  std::vector<Row> rows_;
  std::vector<std::size_t> jumps_;  // rows whose position jumps
  std::vector<std::string> repairs_;
};

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

double encoder_quantum(std::span<const double> positions) {
  std::vector<double> differences;
  double largest = 0.0;
  for (std::size_t k = 1; k < positions.size(); ++k) {
    differences.push_back(std::abs(positions[k] - positions[k - 1]));
    largest = std::max(largest, std::abs(positions[k]));
  }
  std::erase_if(differences, [&](double d) { return d <= 1e-12 * largest; });
  if (differences.empty()) return 0.0;
  std::sort(differences.begin(), differences.end());
  for (double quantum : guesses_of(differences)) {
    if (!explains(differences, quantum)) continue;
    std::vector<double> counts = {0.0}, moved = {0.0};
    for (std::size_t k = 1; k < positions.size(); ++k) {
      counts.push_back(counts.back() + std::round((positions[k] - positions[k - 1]) / quantum));
      moved.push_back(positions[k] - positions.front());
    }
    return boost::math::statistics::simple_ordinary_least_squares(counts, moved).second;
  }
  return 0.0;
}

std::vector<std::string> RecordedAxis::warnings(const std::string& file) const {
  std::vector<std::string> lines;
  if (!repairs.empty()) {
    lines.push_back(fmt::format("{}: repaired: {}", file, fmt::join(repairs, "; ")));
  }
  for (const std::string& doubt : doubts) lines.push_back(fmt::format("{}: {}", file, doubt));
  return lines;
}

RecordedAxis read_recorded_axis(const std::string& file, const RecordFormat& format) {
  const ColumnTable table = read_columns(file,
                                         {{format.time_column, "csv.time_column"},
                                          {format.input_column, "csv.input_column"},
                                          {format.position_column, "csv.position_column"}},
                                         TableKind::laboratory);
  RecordedAxis axis = Repair(file, table, format.time_column).result();
  // Multiplies the numbers of a column. Returns the scale: the given one, or that of its unit.
  const auto multiply = [&](const std::string& unit, double scale,
                            std::initializer_list<std::vector<double>*> numbers) {
    if (scale == 1.0 && unit_in_si(unit).value_or(1.0) != 1.0) {
      scale = *unit_in_si(unit);
      axis.repairs.push_back(
          fmt::format("the unit {} of the first lines: 1 is {:.6g} in SI units", unit, scale));
    }
    for (std::vector<double>* values : numbers) {
      for (double& value : *values) value *= scale;
    }
    return scale;
  };
  multiply(table.units[0], format.time_scale, {&axis.times_s, &axis.input_times_s});
  multiply(table.units[1], format.input_scale, {&axis.inputs, &axis.all_inputs});
  const double scale = multiply(table.units[2], format.position_scale, {&axis.positions});
  check_finite(file, axis);
  axis.doubts = doubts_of(axis, scale != 1.0);
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
