#include <breakwater/study/point_list.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace breakwater {

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
