#include <breakwater/shell/table.h>

#include "support.h"
#include "tables.h"

namespace breakwater::table_test {

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

TEST(Table, IsPrintedWithinAWidth) {
  for (const auto& row : testing::rows_of("PrintedTables")) {
    TextRows rows = {parts_of(row.at(0), ';')};
    for (const std::string& line : parts_of(row.at(1), '/')) rows.push_back(parts_of(line, ';'));
    EXPECT_EQ(in_columns(rows, std::stoul(row.at(3)), std::stoul(row.at(2))), row.at(4));
  }
}

TEST(Wrapped, CutsAtSpaces) {
  EXPECT_EQ(wrapped("one two three", 7), (std::vector<std::string>{"one two", "three"}));
  EXPECT_EQ(wrapped("abcdefgh i", 4), (std::vector<std::string>{"abcdefgh", "i"}));
  EXPECT_EQ(wrapped("", 4), std::vector<std::string>{""});
  EXPECT_EQ(wrapped("† µs † µs", 4), (std::vector<std::string>{"† µs", "† µs"}));
}

}  // namespace breakwater::table_test
