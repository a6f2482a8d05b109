#include <breakwater/scenario/table.h>

#include <fmt/format.h>

#include <algorithm>

namespace breakwater {

std::string Table::print(std::size_t width) const {
  constexpr std::size_t kGap = 2;
  const std::size_t columns = rows_.front().size();
  std::vector<std::size_t> widths(columns, 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }

  std::string text;
  for (std::size_t first = 1; first < columns;) {
    std::size_t last = first;
    std::size_t used = widths[0];
    while (last < columns && (last == first || used + kGap + widths[last] <= width)) {
      used += kGap + widths[last++];
    }
    if (first > 1) text += '\n';
    for (const auto& row : rows_) {
      std::string line = fmt::format("{:<{}}", row[0], widths[0]);
      for (std::size_t i = first; i < std::min(last, row.size()); ++i) {
        line += fmt::format("{:>{}}", row[i], kGap + widths[i]);
      }
      text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
    }
    first = last;
  }
  return text;
}

std::string number_of(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace breakwater
