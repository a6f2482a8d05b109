#include "tables.h"

#include "support.h"

namespace breakwater::testing {

std::vector<Table> tables_of(const std::string& relative) {
  std::vector<Table> tables;
  int number = 0;
  for (const std::string& line : lines_of(text_of(source_file(relative)))) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    if (line[0] == '[' && std::isupper(line[1]) != 0) {
      const std::size_t end = line.find(']');
      tables.push_back({line.substr(1, end - 1), line.substr(std::min(end + 2, line.size())), {}});
      continue;
    }
    if (tables.empty())
      throw std::invalid_argument(relative + ":" + std::to_string(number) + ": is in no table");
    if (line.starts_with("+ ")) {
      tables.back().heading += line.substr(1);
      continue;
    }
    TableRow row{number, {}};
    const std::string separator = " | ";
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find(separator, begin), line.size());
      const std::string cell = line.substr(begin, end - begin);
      row.cells.push_back(cell == "-" ? "" : cell);
      begin = end + separator.size();
    }
    tables.back().rows.push_back(row);
  }
  return tables;
}

std::vector<std::vector<std::string>> rows_of(const std::string& table) {
  static const std::vector<Table> all = tables_of("tests/texts.txt");
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Table& one) { return one.name == table; });
  if (found == all.end() || found->rows.empty()) {
    throw std::invalid_argument("texts.txt has no rows of " + table);
  }
  std::vector<std::vector<std::string>> rows;
  for (const TableRow& row : found->rows) {
    rows.push_back(row.cells);
    for (std::string& cell : rows.back()) {
      for (const auto& [from, to] : {std::pair{"\\n", "\n"}, {"\\t", "\t"}}) {
        for (auto at = cell.find(from); at != std::string::npos; at = cell.find(from, at)) {
          cell.replace(at, 2, to);
        }
      }
    }
  }
  return rows;
}

std::vector<std::string> forms_of(const std::string& text) {
  const std::size_t begin = text.find('{');
  if (begin == std::string::npos) return {text};
  const std::size_t end = text.find('}', begin);
  std::vector<std::string> forms;
  std::istringstream parts(text.substr(begin + 1, end - begin - 1) + "|");
  for (std::string part; std::getline(parts, part, '|');) {
    for (const std::string& rest : forms_of(text.substr(end + 1))) {
      forms.push_back(text.substr(0, begin) + part + rest);
    }
  }
  return forms;
}

std::vector<std::string> words_in(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace breakwater::testing
