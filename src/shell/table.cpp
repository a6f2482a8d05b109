#include <breakwater/shell/table.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace breakwater {
namespace {

// The number of characters of a UTF-8 text.
std::size_t shown_width(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string blanks(std::size_t width, const std::string& text) {
  return std::string(width - std::min(width, shown_width(text)), ' ');
}

TextRows turned_over(const TextRows& rows) {
  TextRows turned(rows.front().size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) turned[i].push_back(row[i]);
  }
  return turned;
}

std::string in_blocks(const TextRows& rows, std::size_t labels, std::size_t width) {
  constexpr std::size_t kGap = 2;
  const std::size_t columns = rows.front().size();
  std::vector<std::size_t> widths(columns, 0);
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < columns; ++i) widths[i] = std::max(widths[i], shown_width(row[i]));
  }
  std::size_t labels_width = widths[0];
  for (std::size_t i = 1; i < labels; ++i) labels_width += kGap + widths[i];
  std::string text;
  for (std::size_t first = labels; first < columns;) {
    std::size_t last = first;
    std::size_t used = labels_width;
    while (last < columns && (last == first || used + kGap + widths[last] <= width)) {
      used += kGap + widths[last++];
    }
    if (first > labels) text += '\n';
    for (const auto& row : rows) {
      // A part of a table has no row without anything in it.
      const bool is_part = first > labels || last < columns;
      const bool is_blank = std::all_of(row.begin() + static_cast<std::ptrdiff_t>(first),
                                        row.begin() + static_cast<std::ptrdiff_t>(last),
                                        [](const std::string& cell) { return cell.empty(); });
      if (is_part && is_blank) continue;
      std::string line = row[0] + blanks(widths[0], row[0]);
      for (std::size_t i = 1; i < labels; ++i) {
        line += std::string(kGap, ' ') + row[i] + blanks(widths[i], row[i]);
      }
      for (std::size_t i = first; i < last; ++i) line += blanks(kGap + widths[i], row[i]) + row[i];
      text += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
    }
    first = last;
  }
  return text;
}

}  // namespace

std::string in_columns(TextRows rows, std::size_t width, std::size_t labels) {
  for (auto& row : rows) row.resize(rows.front().size());
  const std::string upright = in_blocks(rows, labels, width);
  if (upright.find("\n\n") == std::string::npos || rows.size() < 2 || labels > 1) return upright;
  const std::string turned = in_blocks(turned_over(rows), 1, width);
  const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  return lines(turned) < lines(upright) ? turned : upright;
}

std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::stringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.back().empty() && shown_width(lines.back()) + 1 + shown_width(word) > width) {
      lines.emplace_back();
    }
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back() += word;
  }
  return lines;
}

std::string in_digits(double value) {
  constexpr double kLargestWhole = 1e9;
  const bool is_whole = std::abs(value) < kLargestWhole && value == std::round(value);
  return is_whole ? fmt::format("{:.0f}", value) : fmt::format("{:.4g}", value);
}

std::string number_of(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string listed(std::vector<std::string> names) {
  constexpr std::size_t kMostNamed = 3;
  if (names.size() > kMostNamed + 1) {
    const std::size_t more = names.size() - kMostNamed;
    names.resize(kMostNamed);
    names.push_back(fmt::format("{} more", more));
  }
  if (names.size() < 2) return names.empty() ? "" : names.front();
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

std::string duration_text(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.1f} s", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  if (seconds < 172800.0) return fmt::format("{:.1f} h", seconds / 3600.0);
  return fmt::format("{:.1f} days", seconds / 86400.0);
}

}  // namespace breakwater
