// Commands, as a user calls them: refusals.txt and commands.txt, one test a table.
#include <regex>

#include "cli/program.h"
#include "tables.h"

namespace breakwater::commands_test {

namespace fs = std::filesystem;
using testing::ProgramResult;
using testing::Table;

class Commands : public testing::ProgramTest, public ::testing::WithParamInterface<Table> {
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

  // The same for a command, the text of a file, or a part of an output.
  std::string whole(std::string text) const {
    text = filled(text);
    for (const auto& [from, to] : {std::pair{std::string("\\n"), std::string("\n")},
                                   {"\\t", "\t"},
                                   {"HERE", folder_.string()},
                                   {"BIN/", testing::bin_folder().string() + "/"},
                                   {"TEST/", (testing::bin_folder() / "../tests/").string()},
                                   {"PROJECT/", testing::source_file("")}}) {
      for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    }
    return text;
  }

  void prepare(const std::vector<std::string>& cells) {
    const std::string what = cells.at(0).substr(2), &name = cells.at(1);
    if (what == "run") {
      const ProgramResult result = run(whole(name));
      ASSERT_EQ(result.status, cells.size() > 2 ? std::stoi(cells[2]) : 0) << name << result.err;
    } else if (what == "folder") {
      fs::create_directories(folder_ / name);
    } else if (what == "remove") {
      fs::remove_all(folder_ / name);
    } else if (what == "write") {
      write(name, whole(cells.at(2)));
    } else if (what == "file") {
      file_ = name;
      begin_ = cells.at(2);
    } else {
      const std::string text = testing::text_of(source_of(cells.at(2)));
      const std::string kept =
          what == "cut" ? text.substr(0, text.find(cells.at(3)) + cells.at(3).size()) : text;
      write(name, testing::replaced(kept, whole(cells.at(3)), whole(cells.at(4))));
    }
  }

  // "out", "err", "both", "hash:RUN" or a file.
  std::string content_of(const std::string& where, const ProgramResult& result) const {
    if (where == "out") return result.out;
    if (where == "err") return result.err;
    if (where == "both") return result.err + result.out;
    if (where.starts_with("hash:")) return state_hash(where.substr(5));
    EXPECT_TRUE(fs::is_regular_file(folder_ / where)) << "there is no " << where;
    return read(where);
  }

  // Expects "WHERE VERB TEXT".
  void expect(const std::string& check, const ProgramResult& result) const {
    SCOPED_TRACE(check);
    std::istringstream words(check);
    std::string where, verb, text;
    words >> where >> verb;
    std::getline(words.ignore(), text);
    if (verb == "exists" || verb == "absent") {
      EXPECT_EQ(fs::exists(folder_ / where), verb == "exists");
      return;
    }
    if (verb == "holds") {
      EXPECT_EQ(entries(where), testing::words_in(text));
      return;
    }
    const std::string content = content_of(where, result);
    if (verb == "has") {
      const std::string gap = " … ";
      for (std::size_t begin = 0, at = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(gap, begin), text.size());
        const std::string part = whole(text.substr(begin, end - begin));
        ASSERT_TRUE(has(content.substr(at), part));
        at = content.find(part, at) + part.size();
        begin = end + gap.size();
      }
    } else if (verb == "lacks") {
      EXPECT_TRUE(lacks(content, whole(text)));
    } else if (verb == "begins") {
      EXPECT_TRUE(content.starts_with(whole(text))) << content.substr(0, 4000);
    } else if (verb == "is") {
      EXPECT_EQ(content, text.empty() ? "" : whole(text) + "\n");
    } else if (verb == "lines") {
      EXPECT_EQ(testing::lines_of(content).size(), std::stoul(text)) << content;
    } else if (verb == "differs") {
      EXPECT_NE(content, content_of(text, result));
    } else {
      ASSERT_EQ(verb, "equals") << "is no check";
      EXPECT_EQ(content, content_of(text, result));
    }
  }

  // The heading stands before each command, except before the absolute path of a program.
  std::string command_of(const std::string& own) const {
    if (own.empty() || own == "-") return whole(GetParam().heading);
    const bool is_alone = GetParam().heading.empty() || own.starts_with('/');
    return whole(is_alone ? own : GetParam().heading + " " + own);
  }

  void try_row(const std::vector<std::string>& cells) {
    const std::string& first = cells.front();
    if (first.starts_with("! ")) {
      prepare(cells);
    } else if (first.starts_with("> ")) {
      const std::string command = command_of(first.substr(2));
      const ProgramResult result = run(command);
      EXPECT_EQ(result.status, std::stoi(cells.at(1))) << command << '\n' << result.err;
      for (std::size_t i = 2; i < cells.size(); ++i) expect(cells[i], result);
    } else {
      ASSERT_EQ(cells.size(), 3U) << "needs command | exit | line";
      const bool is_text = first.starts_with("< ");
      if (is_text) write(file_, whole(begin_ + first.substr(2)));
      expect_refused(command_of(is_text ? "" : first), filled(cells[2]), std::stoi(cells[1]));
    }
  }

 private:
  std::string file_, begin_;  // for rows that begin with "< "
};

TEST_P(Commands, DoWhatTheirRowsSay) {
  for (const testing::TableRow& row : GetParam().rows) {
    SCOPED_TRACE("line " + std::to_string(row.line));
    try_row(row.cells);
  }
}

INSTANTIATE_TEST_SUITE_P(Refused, Commands,
                         ::testing::ValuesIn(testing::tables_of("tests/cli/refusals.txt")),
                         testing::test_name);
INSTANTIATE_TEST_SUITE_P(Cli, Commands,
                         ::testing::ValuesIn(testing::tables_of("tests/cli/commands.txt")),
                         testing::test_name);

}  // namespace breakwater::commands_test
