#include <breakwater/shell/table.h>

#include <gtest/gtest.h>

#include <limits>

namespace breakwater {
namespace {

constexpr std::size_t kWide = std::numeric_limits<std::size_t>::max();

Table table_of(std::size_t rows, std::size_t columns) {
  std::vector<std::string> header = {"name"};
  for (std::size_t j = 1; j <= columns; ++j) header.push_back("column" + std::to_string(j));
  Table table(header);
  for (std::size_t i = 1; i <= rows; ++i) {
    std::vector<std::string> row = {"row" + std::to_string(i)};
    for (std::size_t j = 1; j <= columns; ++j) row.push_back(std::to_string(10 * i + j));
    table.add(row);
  }
  return table;
}

TEST(Table, IsWholeIfItFits) {
  EXPECT_EQ(table_of(2, 2).print(kWide),
            "name  column1  column2\n"
            "row1       11       12\n"
            "row2       21       22\n");
  EXPECT_EQ(table_of(2, 2).print(22), table_of(2, 2).print(kWide));
}

TEST(Table, IsCutIntoBlocksThatRepeatTheFirstColumn) {
  EXPECT_EQ(table_of(3, 2).print(15),
            "name  column1\n"
            "row1       11\n"
            "row2       21\n"
            "row3       31\n"
            "\n"
            "name  column2\n"
            "row1       12\n"
            "row2       22\n"
            "row3       32\n");
}

TEST(Table, IsTransposedIfThatIsShorter) {
  EXPECT_EQ(table_of(1, 4).print(15),
            "name     row1\n"
            "column1    11\n"
            "column2    12\n"
            "column3    13\n"
            "column4    14\n");
}

TEST(Table, RepeatsAllLabelsInEachBlock) {
  Table table({"metric", "of", "median", "p"}, 2);
  table.add({"peak", "b", "3.5", "0.5"});
  table.add({"peak", "cc", "12", "1"});
  EXPECT_EQ(table.print(18),
            "metric  of  median\n"
            "peak    b      3.5\n"
            "peak    cc      12\n"
            "\n"
            "metric  of    p\n"
            "peak    b   0.5\n"
            "peak    cc    1\n");
}

TEST(Table, LeavesRowsOutOfABlockWithoutAnythingInThem) {
  Table table({"metric", "first", "second"});
  table.add({"peak", "3.5", "4.5"});
  table.add({"difference", "", "+1.0"});
  EXPECT_EQ(table.print(18),
            "metric      first\n"
            "peak          3.5\n"
            "\n"
            "metric      second\n"
            "peak           4.5\n"
            "difference    +1.0\n");
}

TEST(Table, CountsCharactersNotBytes) {
  Table table({"unit", "value"});
  table.add({"µs", "1"});
  table.add({"s", "½"});
  EXPECT_EQ(table.print(kWide),
            "unit  value\n"
            "µs        1\n"
            "s         ½\n");
}

TEST(Wrapped, CutsAtSpaces) {
  EXPECT_EQ(wrapped("one two three", 7), (std::vector<std::string>{"one two", "three"}));
  EXPECT_EQ(wrapped("abcdefgh i", 4), (std::vector<std::string>{"abcdefgh", "i"}));
  EXPECT_EQ(wrapped("", 4), std::vector<std::string>{""});
  EXPECT_EQ(wrapped("† µs † µs", 4), (std::vector<std::string>{"† µs", "† µs"}));
}

}  // namespace
}  // namespace breakwater
