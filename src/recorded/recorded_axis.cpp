#include <breakwater/recorded/recorded_axis.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace breakwater {
namespace {

constexpr std::array<const char*, 3> kColumns = {"time_s", "u", "y"};
constexpr std::size_t kLongestQuote = 40;

std::string_view trimmed(std::string_view text) {
  constexpr const char* kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t from = 0;;) {
    const std::size_t comma = line.find(',', from);
    cells.push_back(trimmed(line.substr(from, comma - from)));
    if (comma == std::string_view::npos) return cells;
    from = comma + 1;
  }
}

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file), stream_(file) {
    if (!stream_) throw std::invalid_argument(file + ": cannot be read");
  }

  // The next line that says something; false at the end.
  bool next(std::string& line) {
    while (std::getline(stream_, line)) {
      ++number_;
      if (number_ == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);  // as Excel writes
      const std::string_view text = trimmed(line);
      if (!text.empty() && text.front() != '#') return true;
    }
    return false;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw std::invalid_argument(file_ + ":" + std::to_string(number_) + ": " + reason);
  }

  double number(std::string_view cell, const char* column) const {
    const std::string_view digits = cell.starts_with('+') ? cell.substr(1) : cell;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc() && end == digits.data() + digits.size() && std::isfinite(value)) {
      return value;
    }
    fail(std::string(column) + ": must be a finite number, is \"" +
         std::string(cell.substr(0, kLongestQuote)) + "\"");
  }

 private:
  std::string file_;
  std::ifstream stream_;
  std::size_t number_ = 0;
};

// Where the columns stand.
std::array<std::size_t, 3> places_of(const std::vector<std::string_view>& header,
                                     const Reader& reader) {
  std::array<std::size_t, 3> places{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::find(header.begin(), header.end(), kColumns[i]);
    if (found == header.end()) {
      reader.fail(std::string("there is no column ") + kColumns[i] +
                  ": the first line must name time_s, u and y");
    }
    if (std::find(found + 1, header.end(), kColumns[i]) != header.end()) {
      reader.fail(std::string("there are two columns ") + kColumns[i]);
    }
    places[i] = static_cast<std::size_t>(found - header.begin());
  }
  return places;
}

}  // namespace

RecordedAxis read_recorded_axis(const std::string& file) {
  Reader reader(file);
  std::string line;
  if (!reader.next(line)) throw std::invalid_argument(file + ": is empty");
  const std::vector<std::string_view> header = cells_of(line);
  const std::array<std::size_t, 3> places = places_of(header, reader);
  const std::size_t width = header.size();

  RecordedAxis axis;
  while (reader.next(line)) {
    const std::vector<std::string_view> cells = cells_of(line);
    if (cells.size() != width) {
      reader.fail("has " + std::to_string(cells.size()) + " values, the first line " +
                  std::to_string(width));
    }
    const double time_s = reader.number(cells[places[0]], kColumns[0]);
    if (!axis.times_s.empty() && !(time_s > axis.times_s.back())) {
      reader.fail("time_s: must be later than in the row before");
    }
    axis.times_s.push_back(time_s);
    axis.inputs.push_back(reader.number(cells[places[1]], kColumns[1]));
    axis.positions.push_back(reader.number(cells[places[2]], kColumns[2]));
  }
  if (axis.times_s.size() < 2) throw std::invalid_argument(file + ": has fewer than two rows");
  return axis;
}

RecordedTiming timing_of(const std::vector<double>& times_s, double period_s, double gap_periods,
                         double jitter_share) {
  std::vector<double> intervals(times_s.size() - 1);
  for (std::size_t k = 0; k < intervals.size(); ++k) intervals[k] = times_s[k + 1] - times_s[k];
  RecordedTiming timing;
  timing.period_s = period_s;
  if (period_s == 0.0) {
    // The mean of what are no gaps by the median: jitter adds up to nothing in it.
    std::vector<double> sorted = intervals;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    double sum = 0.0;
    double count = 0.0;
    for (const double interval : intervals) {
      if (interval > gap_periods * *middle) continue;
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
