#include <breakwater/config/column_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <locale>
#include <numbers>
#include <ranges>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <breakwater/config/config.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/signals/input_file.h>

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

// Whether a cell says that there is no number.
bool is_missing(std::string_view cell) {
  std::string word(cell);
  for (char& letter : word) letter = std::tolower(letter, std::locale::classic());
  if (word.starts_with('+') || (word.starts_with('-') && word.size() > 2)) word.erase(0, 1);
  static constexpr std::string_view kWords[] = {"",         "nan",     "na",    "n/a", "#n/a",
                                                "null",     "none",    "inf",   "-",   "--",
                                                "infinity", "1.#qnan", "1.#inf"};
  return std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords);
}

// A name of the first line, and the unit behind it.
struct HeaderCell {
  std::string name;
  std::string unit;
};

HeaderCell header_cell(std::string_view cell) {
  const std::size_t bracket = cell.find_first_of("[(");
  if (bracket != std::string_view::npos && (cell.back() == ']' || cell.back() == ')')) {
    return {std::string(trimmed(cell.substr(0, bracket))),
            std::string(trimmed(cell.substr(bracket + 1, cell.size() - bracket - 2)))};
  }
  const std::size_t bar = cell.rfind('_');
  if (bar != std::string_view::npos && unit_in_si(cell.substr(bar + 1))) {
    return {std::string(cell.substr(0, bar)), std::string(cell.substr(bar + 1))};
  }
  return {std::string(cell), ""};
}

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file), stream_(open_input(file)) {
    if (!next()) throw std::invalid_argument(file + ": is empty");
    if (line_.starts_with("\xff\xfe") || line_.starts_with("\xfe\xff")) {
      fail("the text is in UTF-16: save it as UTF-8");
    }
    separator_ = separator_of(line_);
    split(line_, separator_, cells_);
  }

  // Splits the next line that is neither empty nor a comment; false at the end.
  bool next_row() {
    if (!next()) return false;
    split(line_, separator_, cells_);
    return true;
  }

  // A row after the first line without a number, with a known unit.
  bool is_row_of_units() const {
    const auto is_word = [](std::string_view cell) {
      return cell.empty() || cell.find_first_of("0123456789") == std::string_view::npos;
    };
    return std::all_of(cells_.begin(), cells_.end(), is_word) &&
           std::any_of(cells_.begin(), cells_.end(), [](std::string_view cell) {
             return unit_in_si(without_brackets(cell)).has_value();
           });
  }
  static std::string_view without_brackets(std::string_view cell) {
    const bool has = cell.size() >= 2 && (cell.front() == '[' || cell.front() == '(');
    return has ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
  }

  char separator() const { return separator_; }
  const std::vector<std::string_view>& cells() const { return cells_; }
  std::size_t line_number() const { return number_; }
  [[noreturn]] void fail(const std::string& reason) const { fail_at_line(file_, number_, reason); }

  double number(std::size_t place, const std::string& column) {
    const std::string_view cell = cells_[place];
    digits_ = cell.starts_with('+') ? cell.substr(1) : cell;
    // A number with both a point and a comma is ambiguous: one of them groups thousands.
    const std::size_t comma = digits_.find(',');
    if (comma != std::string::npos && digits_.find('.') == std::string::npos) {
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

// The index of a column in the names of the first line. `bare` has the names without their units.
std::size_t place_of(const WantedColumn& column, const std::vector<std::string>& names,
                     const std::vector<HeaderCell>& bare, const std::string& file,
                     std::size_t line) {
  const auto index = [&](const auto& is_it) {
    const auto all = std::views::iota(std::size_t{0}, names.size());
    if (std::ranges::count_if(all, is_it) > 1) {
      fail_at_line(file, line, fmt::format("there are two columns {}", column.name));
    }
    return static_cast<std::size_t>(std::ranges::find_if(all, is_it) - all.begin());
  };
  std::size_t place = index([&](std::size_t i) { return names[i] == column.name; });
  if (place == names.size() && !bare.empty()) {
    const std::string wanted = header_cell(column.name).name;
    place = index([&](std::size_t i) { return bare[i].name == wanted && !bare[i].unit.empty(); });
  }
  if (place < names.size()) return place;
  fail_at_line(file, line,
               fmt::format("there is no column {}{}: the first line has {}; {}", column.name,
                           did_you_mean(column.name, names),
                           fmt::format("{}", fmt::join(names, ", ")).substr(0, kLongestHeader),
                           column.key.empty() ? "rename one of them"
                                              : "set " + column.key + " to its name"));
}

}  // namespace

void fail_at_line(const std::string& file, std::size_t line, const std::string& reason) {
  throw std::invalid_argument(fmt::format("{}:{}: {}", file, line, reason));
}

std::optional<double> unit_in_si(std::string_view unit) {
  static constexpr std::pair<std::string_view, double> kUnits[] = {
      {"s", 1.0},
      {"sec", 1.0},
      {"ms", 1e-3},
      {"us", 1e-6},
      {"µs", 1e-6},
      {"ns", 1e-9},
      {"min", 60.0},
      {"Nm", 1.0},
      {"N m", 1.0},
      {"N*m", 1.0},
      {"N·m", 1.0},
      {"mNm", 1e-3},
      {"mN m", 1e-3},
      {"N", 1.0},
      {"mN", 1e-3},
      {"kN", 1e3},
      {"m", 1.0},
      {"mm", 1e-3},
      {"um", 1e-6},
      {"µm", 1e-6},
      {"rad", 1.0},
      {"mrad", 1e-3},
      {"deg", std::numbers::pi / 180.0},
      {"°", std::numbers::pi / 180.0},
      {"rev", 2.0 * std::numbers::pi}};
  for (const auto& [name, value] : kUnits) {
    if (name == unit) return value;
  }
  return std::nullopt;
}

void check_rising(const std::string& file, const ColumnTable& table,
                  const std::vector<double>& times, const std::string& reason) {
  for (std::size_t i = 1; i < table.rows(); ++i) {
    if (!(times[i] > times[i - 1])) fail_at_line(file, table.lines[i], reason);
  }
}

ColumnTable read_columns(const std::string& file, const std::vector<WantedColumn>& wanted,
                         TableKind kind) {
  const bool is_exact = kind == TableKind::exact;
  Reader reader(file);
  const std::size_t header_line = reader.line_number();
  const std::vector<std::string> names(reader.cells().begin(), reader.cells().end());
  const std::size_t width = names.size();
  std::vector<HeaderCell> bare;
  bool has_row = reader.next_row();
  if (!is_exact) {
    for (const std::string& name : names) bare.push_back(header_cell(name));
    if (has_row && reader.cells().size() == width && reader.is_row_of_units()) {
      for (std::size_t i = 0; i < width; ++i) {
        bare[i].unit = Reader::without_brackets(reader.cells()[i]);
      }
      has_row = reader.next_row();
    }
  }
  std::vector<std::size_t> places;
  ColumnTable table;
  for (const WantedColumn& column : wanted) {
    places.push_back(place_of(column, names, bare, file, header_line));
    table.units.push_back(is_exact ? "" : bare[places.back()].unit);
  }
  table.columns.resize(wanted.size());
  for (; has_row; has_row = reader.next_row()) {
    const std::size_t length = reader.cells().size();
    const bool has_empty_end = !is_exact && length == width + 1 && reader.cells().back().empty();
    if (length != width && !has_empty_end) {
      const std::size_t line = reader.line_number();
      if (!is_exact && length < width && !reader.next_row()) {
        table.has_torn_end = true;
        break;
      }
      const bool has_commas = !is_exact && length > width && reader.separator() == ',';
      fail_at_line(file, line,
                   fmt::format("has {} values, the first line {}{}", length, width,
                               has_commas ? " (decimal commas need another separator)" : ""));
    }
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const bool is_absent = !is_exact && is_missing(reader.cells()[places[i]]);
      table.columns[i].push_back(is_absent ? std::numeric_limits<double>::quiet_NaN()
                                           : reader.number(places[i], wanted[i].name));
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
