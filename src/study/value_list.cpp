#include <breakwater/study/value_list.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <regex>
#include <stdexcept>

#include <breakwater/config/toml_text.h>
#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr double kMostValues = 1e7;
constexpr std::size_t kLongest = 200;  // a regular expression overflows the stack for a long text

// The number of 12 digits next to x, if both differ only by rounding (a few units in the last
// place).
double without_rounding(double x) {
  const double written = *number_in(fmt::format("{:.12g}", x));
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(x);
  return std::abs(written - x) <= rounding ? written : x;
}

}  // namespace

bool is_value_list(const std::string& text) {
  static const std::regex begin(R"(\s*(lin|log)\s*\()");
  return std::regex_search(text.substr(0, kLongest), begin, std::regex_constants::match_continuous);
}

std::vector<double> value_list(const std::string& text) {
  static const std::string number = R"(\s*([^\s,()]+)\s*)";
  static const std::regex rule(R"(\s*(lin|log)\s*\()" + number + "," + number + "," + number +
                               R"(\)\s*)");
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument("\"" + text + "\" " + reason);
  };
  std::smatch parts;
  if (text.size() > kLongest || !std::regex_match(text, parts, rule)) {
    refuse("is neither lin(a,b,n) nor log(a,b,n), n values from a to b");
  }
  const auto a = number_in(parts[2]), b = number_in(parts[3]), n = number_in(parts[4]);
  const bool is_log = parts[1] == "log";
  if (!a || !b || !n) refuse("has something else than three finite numbers");
  if (*n < 2.0 || *n > kMostValues || *n != std::floor(*n)) {
    refuse(fmt::format("must be an integer number of values, 2 to {:.0f}", kMostValues));
  }
  if (*a > *b) refuse(fmt::format("must rise: {} is above {}", *a, *b));
  if (*a == *b) refuse("is empty: both ends are the same");
  if (is_log && *a <= 0.0) refuse("must be positive: it is logarithmic");
  if (!std::isfinite(is_log ? *b / *a : *b - *a)) refuse("is too wide");

  const auto count = static_cast<std::size_t>(*n);
  std::vector<double> values(count);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double share = static_cast<double>(i) / (*n - 1.0);
    values[i] = without_rounding(is_log ? *a * math::pow(*b / *a, share) : *a + (*b - *a) * share);
  }
  values.front() = *a + 0.0;  // a file has no integer -0
  values.back() = *b + 0.0;
  return values;
}

std::vector<std::size_t> parse_points(const std::string& text, std::size_t size) {
  const auto fail = [&]() -> std::vector<std::size_t> {
    throw std::invalid_argument(
        fmt::format("--points: {}: must be ranges of 0 to {}: 0-99,120", text, size - 1));
  };
  std::vector<std::size_t> points;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    std::size_t first = 0;
    auto read = std::from_chars(at, end, first);
    if (read.ec != std::errc()) return fail();
    std::size_t last = first;
    if (read.ptr != end && *read.ptr == '-') read = std::from_chars(read.ptr + 1, end, last);
    if (read.ec != std::errc() || last < first || last >= size) return fail();
    for (std::size_t point = first; point <= last; ++point) points.push_back(point);
    if (read.ptr == end) break;
    if (*read.ptr != ',') return fail();
    at = read.ptr + 1;
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::string print_points(const std::vector<std::size_t>& points) {
  std::string text;
  for (std::size_t i = 0; i < points.size();) {
    std::size_t end = i + 1;
    while (end < points.size() && points[end] == points[end - 1] + 1) ++end;
    if (!text.empty()) text += ',';
    text += std::to_string(points[i]);
    if (end - i > 1) text += fmt::format("-{}", points[end - 1]);
    i = end;
  }
  return text;
}

}  // namespace breakwater
