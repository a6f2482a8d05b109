// Commands that are refused: refusals.txt, one test a table.
#include <regex>

#include "cli/program.h"
#include "tables.h"

namespace breakwater::refusals_test {
namespace {

namespace fs = std::filesystem;
using testing::Table;

class Refusals : public testing::ProgramTest, public ::testing::WithParamInterface<Table> {
 protected:
  std::string source_of(const std::string& file) const {
    const std::string project = "PROJECT/";
    if (file.starts_with(project)) return testing::source_file(file.substr(project.size()));
    return fs::exists(folder_ / file) ? (folder_ / file).string() : testing::source_file(file);
  }

  // The text with LINE(FILE: TEXT) and REPEAT(N, TEXT) replaced.
  std::string filled(std::string text) const {
    static const std::regex line(R"(LINE\(([^:)]*): ([^)]*)\))"),
        repeat(R"(REPEAT\((\d+), ([^)]*)\))");
    std::smatch part;
    while (std::regex_search(text, part, line)) {
      const std::string number = testing::line_of(testing::text_of(source_of(part[1])), part[2]);
      text = part.prefix().str() + number + part.suffix().str();
    }
    while (std::regex_search(text, part, repeat)) {
      const std::string all = testing::repeated(part[2], std::stoi(part[1]));
      text = part.prefix().str() + all + part.suffix().str();
    }
    return text;
  }

  // The same for a command, or the text of a file.
  std::string command(std::string text) const {
    text = filled(text);
    for (const auto& [from, to] : {std::pair{std::string("\\n"), std::string("\n")},
                                   {"HERE", folder_.string()},
                                   {"PROJECT/", testing::source_file("")}}) {
      for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    }
    return text;
  }

  void prepare(const std::vector<std::string>& cells) const {
    const std::string what = cells.at(0).substr(2), &name = cells.at(1);
    if (what == "run") {
      const int status = cells.size() > 2 ? std::stoi(cells[2]) : 0;
      ASSERT_EQ(run(command(name)).status, status) << name;
    } else if (what == "folder") {
      fs::create_directories(folder_ / name);
    } else if (what == "remove") {
      fs::remove_all(folder_ / name);
    } else if (what == "write") {
      write(name, command(cells.at(2)));
    } else {
      const std::string text = testing::text_of(source_of(cells.at(2)));
      const std::string kept =
          what == "cut" ? text.substr(0, text.find(cells.at(3)) + cells.at(3).size()) : text;
      write(name, testing::replaced(kept, cells.at(3), command(cells.at(4))));
    }
  }
};

TEST_P(Refusals, AreOneLineAndLeaveNothing) {
  for (const testing::TableRow& row : GetParam().rows) {
    SCOPED_TRACE("refusals.txt:" + std::to_string(row.line));
    if (row.cells.front().starts_with("! ")) {
      prepare(row.cells);
      continue;
    }
    ASSERT_EQ(row.cells.size(), 3U) << "needs command | exit | line";
    const std::string begin = GetParam().heading.empty() ? "" : GetParam().heading + " ";
    expect_refused(command(begin + row.cells[0]), filled(row.cells[2]), std::stoi(row.cells[1]));
  }
}

INSTANTIATE_TEST_SUITE_P(Cli, Refusals,
                         ::testing::ValuesIn(testing::tables_of("tests/cli/refusals.txt")),
                         testing::test_name);

}  // namespace
}  // namespace breakwater::refusals_test
