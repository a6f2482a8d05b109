// docs/reference/from-equation-to-code.md and the equation numbers in comments agree.
#include <regex>

#include "support.h"
#include "tables.h"

namespace breakwater::equations_test {
namespace fs = std::filesystem;

struct Equation {
  int chapter;
  int number;
  auto operator<=>(const Equation&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Equation& equation) {
  return out << equation.chapter << '.' << equation.number;
}

using Equations = std::vector<Equation>;

/// The last equation of each chapter.
const std::vector<Equation> kLast = {{2, 93}, {3, 31}, {4, 27}};

const std::string kNumber = "([2-9])\\.([0-9]+)(?!\\.?[0-9])";  // not a section's number

Equation equation_of(const std::smatch& match, std::size_t first = 1) {
  return {std::stoi(match[first]), std::stoi(match[first + 1])};
}

/// Reads a list such as "2.4", "2.1–2.3", "2.9, 2.10 and 4.1–4.4" from a position, adds its
/// entries, and returns its end. A range must ascend within a chapter.
std::string::const_iterator read_list(std::string::const_iterator at,
                                      std::string::const_iterator end, Equations& equations) {
  static const std::regex first(kNumber);
  static const std::regex next("(–|-| to |, and |, |; | and | or )" + kNumber);
  const auto here = std::regex_constants::match_continuous;
  std::smatch match;
  if (!std::regex_search(at, end, match, first, here)) return at;
  equations.push_back(equation_of(match));
  at = match[0].second;
  while (std::regex_search(at, end, match, next, here)) {
    const Equation before = equations.back();
    const Equation equation = equation_of(match, 2);
    const std::string separator = match[1];
    if (separator == "–" || separator == "-" || separator == " to ") {
      EXPECT_TRUE(before.chapter == equation.chapter && before.number < equation.number)
          << "no range: " << before << " to " << equation;
      for (int i = before.number + 1; i < equation.number; ++i) {
        equations.push_back({equation.chapter, i});
      }
    }
    equations.push_back(equation);
    at = match[0].second;
  }
  return at;
}

/// All equations that a text names by "Eq." or "Eqs.". A list may continue in the next line of a
/// comment.
std::set<Equation> named(const std::string& source) {
  static const std::regex line_break("[ \t]*\r?\n[ \t]*(///?<?|#)?[ \t]*");
  static const std::regex mark("\\bEqs?\\. ");
  const std::string text = std::regex_replace(source, line_break, " ");
  Equations equations;
  auto at = text.cbegin();
  for (std::smatch match; std::regex_search(at, text.cend(), match, mark);) {
    at = read_list(match[0].second, text.cend(), equations);
  }
  return {equations.begin(), equations.end()};
}

std::string text_of(const fs::path& file) {
  EXPECT_TRUE(std::ifstream(file)) << file;
  return testing::text_of(file);
}

/// A line that begins with equations. It is a table row with links to code, or a list
/// item that explains why there is none.
struct Entry {
  std::string place;  // file and line
  bool is_row;
  Equations equations;
  std::vector<std::string> code;  // paths from the project's folder
};

const std::string kPage = "docs/reference/from-equation-to-code.md";

/// The page, and the CSV files that it shows as tables. Links in their cells start at the page.
std::vector<std::string> files_of_the_page() {
  const std::regex table("\\]\\(([^()]+\\.csv)\\)<!-- table -->");
  const std::string page = text_of(testing::source_file(kPage));
  std::vector<std::string> files = {kPage};
  for (std::sregex_iterator i(page.begin(), page.end(), table), none; i != none; ++i) {
    files.push_back("docs/reference/" + (*i)[1].str());
  }
  return files;
}

std::vector<Entry> entries_of_the_page() {
  std::vector<Entry> entries;
  const std::regex code("\\]\\((?:\\.\\./)+((?:src|scenarios)/[^)#]+)\\)");
  for (const std::string& file : files_of_the_page()) {
    const bool is_row = file != kPage;
    std::istringstream text(text_of(testing::source_file(file)));
    int number = 0;
    for (std::string line; std::getline(text, line);) {
      ++number;
      if (!is_row && !line.starts_with("- ")) continue;
      const bool quoted = line.starts_with('"');
      Entry entry{file + ":" + std::to_string(number), is_row, {}, {}};
      const auto begin = line.cbegin() + (is_row ? quoted : 2);
      const auto end = read_list(begin, line.cend(), entry.equations);
      if (entry.equations.empty()) continue;  // a table's head
      EXPECT_TRUE(std::string(end, line.cend())
                      .starts_with(!is_row  ? ": "
                                   : quoted ? "\","
                                            : ","))
          << entry.place << ": what follows the equations?";
      for (std::sregex_iterator link(line.begin(), line.end(), code), none; link != none; ++link) {
        entry.code.push_back((*link)[1]);
      }
      entries.push_back(entry);
    }
  }
  return entries;
}

TEST(Equations, AreParsedAsWritten) {
  const auto text = [](const std::string& source) {
    std::ostringstream out;
    for (const Equation& equation : named(source)) out << equation << ' ';
    return out.str();
  };
  for (const auto& row : testing::rows_of("Equations")) {
    EXPECT_EQ(text(row.at(0)), row.at(1) + (row.at(1).empty() ? "" : " "));
  }
}

TEST(Equations, ThePageHasEachEquationOfTheThesisOnce) {
  std::map<Equation, int> count;
  for (const Entry& entry : entries_of_the_page()) {
    for (const Equation& equation : entry.equations) ++count[equation];
  }
  std::size_t all = 0;
  for (const auto& [chapter, last] : kLast) {
    for (int number = 1; number <= last; ++number) {
      EXPECT_EQ((count[{chapter, number}]), 1) << chapter << '.' << number;
      ++all;
    }
  }
  EXPECT_EQ(count.size(), all) << "the page has an equation that the thesis has not";
}

TEST(Equations, TheFilesOfARowNameItsEquations) {
  int rows = 0;
  for (const Entry& entry : entries_of_the_page()) {
    if (!entry.is_row) {
      EXPECT_TRUE(entry.code.empty()) << entry.place << ": an item of the list has code";
      continue;
    }
    ++rows;
    EXPECT_FALSE(entry.code.empty()) << entry.place << ": no file";
    for (const std::string& file : entry.code) {
      const std::set<Equation> there = named(text_of(testing::source_file(file)));
      for (const Equation& equation : entry.equations) {
        EXPECT_TRUE(there.contains(equation))
            << entry.place << ": " << file << " lacks Eq. " << equation;
      }
    }
  }
  EXPECT_GT(rows, 50);
}

TEST(Equations, EachEquationInTheCodeHasARow) {
  std::set<Equation> in_rows;
  for (const Entry& entry : entries_of_the_page()) {
    if (entry.is_row) in_rows.insert(entry.equations.begin(), entry.equations.end());
  }
  int files = 0;
  for (const std::string folder : {"src", "scenarios"}) {
    for (const auto& file : fs::recursive_directory_iterator(testing::source_file(folder))) {
      const std::string extension = file.path().extension().string();
      if (extension != ".h" && extension != ".cpp" && extension != ".toml") continue;
      const std::set<Equation> there = named(text_of(file.path()));
      if (!there.empty()) ++files;
      for (const Equation& equation : there) {
        EXPECT_TRUE(in_rows.contains(equation)) << file.path() << " names Eq. " << equation;
      }
    }
  }
  EXPECT_GT(files, 30);
}

TEST(Equations, ThePagesLinksLeadSomewhere) {
  const std::regex link("\\]\\(([^)#]+)(#[^)]*)?\\)");
  for (const std::string& file : files_of_the_page()) {
    const std::string text = text_of(testing::source_file(file));
    for (std::sregex_iterator i(text.begin(), text.end(), link), none; i != none; ++i) {
      EXPECT_TRUE(fs::exists(testing::source_file("docs/reference/" + (*i)[1].str())))
          << file << ": " << (*i)[1];
    }
  }
}

}  // namespace breakwater::equations_test
