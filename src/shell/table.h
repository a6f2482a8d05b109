// Plain text: tables, and counts in sentences.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// Rows of cells under a header. The first column is set left, the others right.
class Table {
 public:
  /// The first `labels` columns say what a row is.
  explicit Table(std::vector<std::string> header, std::size_t labels = 1)
      : rows_{std::move(header)}, labels_(labels) {}

  void add(std::vector<std::string> row) {
    row.resize(rows_.front().size());
    rows_.push_back(std::move(row));
  }

  /// A table that is wider than `width` characters is cut into several, each with the labels. One
  /// of a single label is turned over before, rows for columns, if that takes fewer lines.
  std::string print(std::size_t width) const;

 private:
  std::vector<std::vector<std::string>> rows_;  // all as long as the first
  std::size_t labels_;
};

/// The text in lines of at most `width` characters, cut at spaces; a longer word is a line of its
/// own. One line at least.
std::vector<std::string> wrapped(const std::string& text, std::size_t width);

/// "1 run", "2 runs".
std::string number_of(std::size_t count, const std::string& what);

/// "12.3 s", "20 min", "3.4 h", "2.0 days".
std::string duration_text(double seconds);

}  // namespace breakwater
