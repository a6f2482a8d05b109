// Plain text: tables, and counts in sentences.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// Rows of cells under a header. The first column is set left, the others right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}

  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  /// Wider tables than `width` characters are cut into several, each with the first column.
  std::string print(std::size_t width) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// "1 run", "2 runs".
std::string number_of(std::size_t count, const std::string& what);

}  // namespace breakwater
