// Columns of numbers in a text file, as a laboratory's programs write them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <breakwater/math/table_function.h>

namespace breakwater {

/// Columns of a table, all with the same rows.
struct ColumnTable {
  std::vector<std::vector<double>> columns;  ///< in the order of the wanted columns
  std::vector<std::size_t> lines;            ///< the line of each row in the file, counted from 1
  std::vector<std::string> units;  ///< the unit of each column; empty if the table names none
  bool has_torn_end = false;       ///< the last line was left out

  std::size_t rows() const { return lines.size(); }
};

/// A wanted column: its name in the first line, and the key that sets this name, if any.
struct WantedColumn {
  std::string name;
  std::string key = {};
};

/// How strict the reader is. `laboratory`: a cell without a number (empty, "NaN", "n/a", ...) is
/// NaN. A shorter last line is left out. A name may have a unit behind it ("time [ms]", "y_deg"),
/// or the second line has the units. "time [ms]" then stands for `time_s`, too.
enum class TableKind { exact, laboratory };

/// Reads the columns `wanted`, in any order and among others. The first line has the names of the
/// columns. The separator is the first of semicolon, tab, comma and blank that it contains. If this
/// is not a comma, or the cell is quoted, numbers may have a decimal comma. Names and cells may be
/// in double quotes. Empty lines and lines that begin with '#' are skipped.
///
/// Throws std::invalid_argument `FILE[:LINE]: reason` if it cannot be read, a column is missing or
/// double, or a row has another length or a wrong number.
ColumnTable read_columns(const std::string& file, const std::vector<WantedColumn>& wanted,
                         TableKind kind = TableKind::exact);

/// Throws std::invalid_argument `FILE:LINE: reason`.
[[noreturn]] void fail_at_line(const std::string& file, std::size_t line,
                               const std::string& reason);

/// The value of a unit in s, m, rad, N or N m: 1e-3 for "ms". Nothing if it is unknown.
std::optional<double> unit_in_si(std::string_view unit);

/// Reads a function of time from the columns time_s, which must rise, and `value`. Throws as
/// read_columns() does, and if there is no row.
math::TableFunction read_function(const std::string& file, const std::string& value);

/// Throws std::invalid_argument `FILE:LINE: reason` for the first row whose time is not later than
/// that of the row before. `times` has one value for each row of the table, in any unit.
void check_rising(const std::string& file, const ColumnTable& table,
                  const std::vector<double>& times, const std::string& reason);

}  // namespace breakwater
