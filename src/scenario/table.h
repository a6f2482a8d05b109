// Plain-text tables.
#pragma once

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

}  // namespace breakwater
