// Plain text: tables, and counts in sentences.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// Rows of cells under a header. The first column is aligned left, the others right.
class Table {
 public:
  /// The first `labels` columns identify the rows.
  explicit Table(std::vector<std::string> header, std::size_t labels = 1)
      : rows_{std::move(header)}, labels_(labels) {}

  void add(std::vector<std::string> row) {
    row.resize(rows_.front().size());
    rows_.push_back(std::move(row));
  }

  /// Splits a table wider than `width` characters into several, each with the labels and without
  /// rows that have nothing in it. A table with one label is transposed before if that takes fewer
  /// lines.
  std::string print(std::size_t width) const;

 private:
  std::vector<std::vector<std::string>> rows_;  // all as long as the first one
  std::size_t labels_;
};

/// Breaks the text at spaces into lines of at most `width` characters. A longer word has its own
/// line. Returns at least one line.
std::vector<std::string> wrapped(const std::string& text, std::size_t width);

/// A number with four significant digits, a whole one below 1e9 with all. Files have all digits.
std::string in_digits(double value);

/// "1 run", "2 runs".
std::string number_of(std::size_t count, const std::string& what);

/// "A, B and C"; of five or more the first three: "A, B, C and 2 more".
std::string listed(std::vector<std::string> names);

/// "12.3 s", "20 min", "3.4 h", "2.0 days".
std::string duration_text(double seconds);

}  // namespace breakwater
