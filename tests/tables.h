// Tests as tables: text files whose rows are tests.
#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

namespace breakwater::testing {

struct TableRow {
  int line = 0;
  std::vector<std::string> cells;
};

/// One test: `[Name] HEADING`, with a capital letter, then its rows.
struct Table {
  std::string name;
  std::string heading;
  std::vector<TableRow> rows;
};

/// The tables of a project's file. " | " separates the cells of a row, and "-" is an empty cell. A
/// line with only "+ " at its begin goes on the heading. # begins a comment line. Throws
/// std::invalid_argument for a row before the first table.
std::vector<Table> tables_of(const std::string& relative);

/// The cells of each row of a table of tests/texts.txt, in which "\n" ends a line and "\t" is a
/// tab. Throws std::invalid_argument if it has no rows.
std::vector<std::vector<std::string>> rows_of(const std::string& table);

/// A text in all its forms: "{a|b}c" is "ac" and "bc".
std::vector<std::string> forms_of(const std::string& text);

/// The words between blanks.
std::vector<std::string> words_in(const std::string& text);

/// The name of a table as that of a test, for INSTANTIATE_TEST_SUITE_P.
inline std::string test_name(const ::testing::TestParamInfo<Table>& table) {
  return table.param.name;
}

inline void PrintTo(const Table& table, std::ostream* out) {
  *out << table.name;
}

}  // namespace breakwater::testing
