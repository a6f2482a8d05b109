// Columns of numbers in a text file, as a laboratory's programs write them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <breakwater/math/table_function.h>

namespace breakwater {

/// Columns of a table, all with the same rows.
struct ColumnTable {
  std::vector<std::vector<double>> columns;  ///< in the order of the wanted columns
  std::vector<std::size_t> lines;            ///< the line of each row in the file, counted from 1

  std::size_t rows() const { return lines.size(); }
};

/// A wanted column: its name in the first line, and the key that sets this name, if any.
struct WantedColumn {
  std::string name;
  std::string key = {};
};

/// Reads the columns `wanted`, in any order and among others. The first line has the names of the
/// columns. The separator is the first of semicolon, tab, comma and blank that it contains. If this
/// is not a comma, numbers may have a decimal comma. Names and cells may be in double quotes. Empty
/// lines and lines that begin with '#' are skipped.
///
/// Throws std::invalid_argument `FILE[:LINE]: reason` if it cannot be read, a column is missing or
/// double, or a row has another length or a wrong number.
ColumnTable read_columns(const std::string& file, const std::vector<WantedColumn>& wanted);

/// Reads a function of time from the columns time_s, which must rise, and `value`. Throws as
/// read_columns() does, and if there is no row.
math::TableFunction read_function(const std::string& file, const std::string& value);

/// Throws std::invalid_argument `FILE:LINE: reason` for the first row whose time is not later than
/// that of the row before. `times` has one value for each row of the table, in any unit.
void check_rising(const std::string& file, const ColumnTable& table,
                  const std::vector<double>& times, const std::string& reason);

}  // namespace breakwater
