// Columns of numbers in a text file, as a lab's programs write them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace breakwater {

/// Columns of a table; row k of all belongs together.
struct ColumnTable {
  std::vector<std::vector<double>> columns;  ///< in the order in which they were asked for
  std::vector<std::size_t> lines;            ///< where each row stands in the file, from 1 on

  std::size_t rows() const { return lines.size(); }
};

/// A column that is wanted: its name in the table's first line, and the key that says that name.
struct WantedColumn {
  std::string name;
  std::string key;
};

/// Reads the columns `wanted`, which may stand in any order between others. The first line names
/// the columns. It also says what separates them: a semicolon, else a tab, else a comma, else
/// blanks. Where that is no comma, a number may have a decimal comma. Names and cells may stand in
/// double quotes. Lines that are empty or begin with '#' are skipped.
///
/// Throws std::invalid_argument `FILE[:LINE]: reason` if it cannot be read, a column is missing or
/// there twice, a row has another length, or a value is no finite number.
ColumnTable read_columns(const std::string& file, const std::vector<WantedColumn>& wanted);

/// The error of a line: throws std::invalid_argument `FILE:LINE: reason`.
[[noreturn]] void fail_at_line(const std::string& file, std::size_t line,
                               const std::string& reason);

}  // namespace breakwater
