#include <breakwater/config/column_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include <breakwater/config/config.h>
#include <breakwater/record/input_file.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {
namespace {

constexpr const char* kBlank = " \t\r";
constexpr char kBlanks = ' ';  // as a separator: any number of blanks
constexpr std::size_t kLongestQuote = 40;
constexpr std::size_t kLongestHeader = 200;

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// The end of the cell that begins at `from`. A separator between quotes does not end it.
std::size_t end_of_cell(std::string_view line, std::size_t from, char separator) {
  bool is_quoted = false;
  for (std::size_t i = from; i < line.size(); ++i) {
    if (line[i] == '"') is_quoted = !is_quoted;
    const bool ends = line[i] == separator || (separator == kBlanks && line[i] == '\t');
    if (ends && !is_quoted) return i;
  }
  return std::string_view::npos;
}

// Throws std::invalid_argument `FILE:LINE: reason`.
[[noreturn]] void fail_at_line(const std::string& file, std::size_t line,
                               const std::string& reason) {
  throw std::invalid_argument(fmt::format("{}:{}: {}", file, line, reason));
}

void split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  line = separator == '\t' ? line : trimmed(line);
  for (std::size_t from = 0;;) {
    const std::size_t end = end_of_cell(line, from, separator);
    std::string_view cell = trimmed(line.substr(from, end - from));
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
      cell = trimmed(cell.substr(1, cell.size() - 2));
    }
    cells.push_back(cell);
    if (end == std::string_view::npos) return;
    from = separator == kBlanks ? line.find_first_not_of(kBlank, end) : end + 1;
  }
}

char separator_of(std::string_view header) {
  for (const char separator : {';', '\t', ','}) {
    if (end_of_cell(header, 0, separator) != std::string_view::npos) return separator;
  }
  return kBlanks;
}

std::string shown(std::string_view cell) {
  return fmt::format("\"{}\"", cell.substr(0, kLongestQuote));
}

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file), stream_(open_input(file)) {
    if (!next()) throw std::invalid_argument(file + ": is empty");
    separator_ = separator_of(line_);
    split(line_, separator_, cells_);
  }

  // Splits the next line that is neither empty nor a comment; false at the end.
  bool next_row() {
    if (!next()) return false;
    split(line_, separator_, cells_);
    return true;
  }

  const std::vector<std::string_view>& cells() const { return cells_; }
  std::size_t line_number() const { return number_; }
  [[noreturn]] void fail(const std::string& reason) const { fail_at_line(file_, number_, reason); }

  double number(std::size_t place, const std::string& column) {
    const std::string_view cell = cells_[place];
    digits_ = cell.starts_with('+') ? cell.substr(1) : cell;
    // A number with both a point and a comma is ambiguous: one of them groups thousands.
    const std::size_t comma = digits_.find(',');
    if (separator_ != ',' && comma != std::string::npos && digits_.find('.') == std::string::npos) {
      digits_[comma] = '.';
    }
    double value = 0.0;
    const char* const last = digits_.data() + digits_.size();
    const auto [end, error] = std::from_chars(digits_.data(), last, value);
    if (error == std::errc() && end == last && std::isfinite(value)) return value;
    fail(fmt::format("{}: must be a finite number, is {}", column, shown(cell)));
  }

 private:
  bool next() {
    while (std::getline(stream_, line_)) {
      ++number_;
      if (number_ == 1 && line_.starts_with("\xef\xbb\xbf"))
        line_.erase(0, 3);  // Excel writes this mark
      const std::string_view text = trimmed(line_);
      if (!text.empty() && text.front() != '#') return true;
    }
    return false;
  }

  std::string file_;
  std::ifstream stream_;
  std::size_t number_ = 0;
  char separator_ = ',';
  std::string line_;
  std::vector<std::string_view> cells_;  // the cells of the current line
  std::string digits_;
};

// The index of a column.
std::size_t place_of(const WantedColumn& column, const Reader& reader) {
  const std::vector<std::string_view>& header = reader.cells();
  const auto found = std::find(header.begin(), header.end(), column.name);
  if (found == header.end()) {
    const std::vector<std::string> names(header.begin(), header.end());
    reader.fail(fmt::format(
        "there is no column {}{}: the first line has {}; {}", column.name,
        did_you_mean(column.name, names),
        fmt::format("{}", fmt::join(names, ", ")).substr(0, kLongestHeader),
        column.key.empty() ? "rename one of them" : "set " + column.key + " to its name"));
  }
  if (std::find(found + 1, header.end(), column.name) != header.end()) {
    reader.fail(fmt::format("there are two columns {}", column.name));
  }
  return static_cast<std::size_t>(found - header.begin());
}

}  // namespace

void check_rising(const std::string& file, const ColumnTable& table,
                  const std::vector<double>& times, const std::string& reason) {
  for (std::size_t i = 1; i < table.rows(); ++i) {
    if (!(times[i] > times[i - 1])) fail_at_line(file, table.lines[i], reason);
  }
}

ColumnTable read_columns(const std::string& file, const std::vector<WantedColumn>& wanted) {
  Reader reader(file);
  std::vector<std::size_t> places;
  for (const WantedColumn& column : wanted) places.push_back(place_of(column, reader));
  const std::size_t width = reader.cells().size();
  ColumnTable table;
  table.columns.resize(wanted.size());
  while (reader.next_row()) {
    if (reader.cells().size() != width) {
      reader.fail(fmt::format("has {} values, the first line {}", reader.cells().size(), width));
    }
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      table.columns[i].push_back(reader.number(places[i], wanted[i].name));
    }
    table.lines.push_back(reader.line_number());
  }
  return table;
}

math::TableFunction read_function(const std::string& file, const std::string& value) {
  ColumnTable table = read_columns(file, {{"time_s"}, {value}});
  if (table.rows() == 0) throw std::invalid_argument(file + ": has no rows");
  check_rising(file, table, table.columns[0], "time_s must rise");
  return {std::move(table.columns[0]), std::move(table.columns[1])};
}

}  // namespace breakwater
