#include <breakwater/thesis/experiments.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/paths.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

using Variables = std::map<std::string, std::string>;

constexpr std::int64_t kMostPanels = 1000;

// Tables with increasing priority, whose texts may contain {VARIABLES}. They are not merged, since
// a merged table has no line numbers.
struct Scope {
  explicit Scope(const TomlEntry& table, Variables values = {})
      : tables{table}, variables(std::move(values)) {}

  TomlEntry operator[](const std::string& key) const {
    const auto found = std::find_if(tables.rbegin(), tables.rend(), [&](const TomlEntry& table) {
      return static_cast<bool>(table[key]);
    });
    return (found == tables.rend() ? tables.back() : *found)[key];
  }
  std::size_t line() const { return tables.back().line(); }
  std::string text(const std::string& key) const { return text((*this)[key]); }
  std::string text_or_nothing(const std::string& key) const {
    return (*this)[key] ? text(key) : "";
  }
  std::vector<std::string> texts(const std::string& key) const {
    std::vector<std::string> all;
    for (const TomlEntry& entry : (*this)[key].elements()) all.push_back(text(entry));
    return all;
  }

  std::string text(const TomlEntry& entry) const;

  std::vector<TomlEntry> tables;
  Variables variables;
};

// A text, or a number as text.
std::string plain(const TomlEntry& entry) {
  if (!entry) entry.fail("is missing");
  if (const auto* string = entry.node()->as_string()) return string->get();
  if (const auto* integer = entry.node()->as_integer()) return fmt::format("{}", integer->get());
  if (const auto* real = entry.node()->as_floating_point()) return fmt::format("{}", real->get());
  entry.fail("must be a text or a number");
}

// The text of an entry with each {NAME} replaced. The value of a variable may contain variables
// too.
std::string Scope::text(const TomlEntry& entry) const {
  constexpr int kMostReplacements = 100;
  std::string text = plain(entry);
  for (int i = 0; text.find('{') != std::string::npos; ++i) {
    const std::size_t open = text.find('{');
    const std::size_t close = text.find('}', open);
    const std::string name = text.substr(open + 1, close - open - 1);
    const auto found = variables.find(name);
    if (close == std::string::npos || found == variables.end() || i == kMostReplacements) {
      entry.fail(fmt::format("\"{}\": there is no {{{}}}", text, name));
    }
    text.replace(open, close - open + 1, found->second);
  }
  return text;
}

// Adds the texts and numbers of a table to variables.
Variables with(Variables variables, const TomlEntry& more) {
  for (const auto& [key, entry] : more.entries()) {
    const bool is_plain = entry.node()->is_string() || entry.node()->is_number();
    if (is_plain) variables[key] = plain(entry);
  }
  return variables;
}

// The combinations of the lists `for` and `and`; one without variables if there are no lists.
std::vector<Variables> combinations(const TomlEntry& table) {
  std::vector<Variables> all = {{}};
  for (const char* key : {"for", "and"}) {
    if (!table[key]) continue;
    std::vector<Variables> longer;
    for (const Variables& variables : all) {
      for (const TomlEntry& entry : table[key].elements()) longer.push_back(with(variables, entry));
    }
    all = longer;
  }
  return all;
}

// One of `words`; empty if the entry is missing.
std::string word_or_nothing(const TomlEntry& entry, const std::vector<std::string>& words) {
  std::string word = entry.text_or_nothing();
  if (!word.empty() && std::find(words.begin(), words.end(), word) == words.end()) {
    entry.fail(fmt::format("\"{}\" must be {}", word, fmt::join(words, " or ")));
  }
  return word;
}

// The number of repetitions from [full, quick].
int repetitions(const TomlEntry& entry, Effort effort) {
  constexpr std::int64_t kMostRepetitions = 1'000'000;
  const std::vector<TomlEntry> both = entry.elements();
  if (both.size() != 2) entry.fail("must be [full, quick]");
  return static_cast<int>(both[effort == Effort::full ? 0 : 1].whole(1, kMostRepetitions));
}

// A number whose text may contain variables.
double real(const Scope& scope, const std::string& key) {
  const std::string written = scope.text(key);
  const char* const end = written.data() + written.size();
  double value = 0.0;
  const auto result = std::from_chars(written.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) {
    scope[key].fail(fmt::format("\"{}\" is no number", written));
  }
  return value;
}

void read_runs(const TomlEntry& table, Effort effort, std::map<std::string, RunSpec>& runs) {
  table.allow({"name", "scenario", "case", "sets", "for", "and", "seeds", "spread", "except"});
  for (const Variables& variables : combinations(table)) {
    const Scope scope(table, variables);
    RunSpec run;
    run.name = scope.text("name");
    run.scenario = scope.text("scenario");
    run.case_name = scope.text("case");
    run.sets = scope.texts("sets");
    run.line = table.line();
    if (const TomlEntry seeds = table["seeds"]) {
      const int count = repetitions(seeds, effort);
      for (int seed = 1; seed <= count; ++seed) {
        run.repetitions.push_back({fmt::format("run.seed={}", seed)});
      }
    } else if (const TomlEntry spread = table["spread"]) {
      spread.allow({"key", "width", "count"});
      const Scope over(spread, variables);
      const std::string key = over.text("key");
      const double width = real(over, "width");
      const int count = width > 0.0 ? repetitions(spread["count"], effort) : 1;
      for (int i = 0; i < count; ++i) {
        run.repetitions.push_back(
            {fmt::format("{}={:.17g}", key, width * ((i + 0.5) / count - 0.5))});
      }
    } else {
      run.repetitions = {{}};
    }
    if (!runs.emplace(run.name, run).second) {
      table.fail("there is a run " + run.name + " already");
    }
  }
}

CellSpec read_cell(const Scope& cell) {
  CellSpec spec;
  spec.line = cell.line();
  spec.quantity = {cell.text("run"), cell.text("metric")};
  if (cell["over"] || cell["over_metric"]) {
    spec.over = spec.quantity;
    if (cell["over"]) spec.over->run = cell.text("over");
    if (cell["over_metric"]) spec.over->metric = cell.text("over_metric");
  }
  spec.divisor = cell["divisor"].number_or_nothing().value_or(1.0);
  if (spec.divisor == 0.0) cell["divisor"].fail("must not be zero");
  spec.if_failed = cell["if_failed"].number_or_nothing().value_or(spec.if_failed);
  spec.absent_is_never = word_or_nothing(cell["absent"], {"never"}) == "never";
  spec.is_share = word_or_nothing(cell["statistic"], {"median", "share"}) == "share";
  spec.printed = cell.text_or_nothing("printed");
  spec.says = cell.text_or_nothing("says");
  spec.shows = cell.text_or_nothing("shows");
  spec.why = cell.text_or_nothing("why");
  spec.vacuous = cell.text_or_nothing("vacuous");
  spec.hypothesis = cell.text_or_nothing("hypothesis");
  spec.holds.above = cell["above"].number_or_nothing();
  spec.holds.below = cell["below"].number_or_nothing();
  const auto fail = [&](const std::string& reason) { cell.tables.back().fail(reason); };
  const auto kinds = {spec.printed.empty(), spec.says.empty(), spec.shows.empty()};
  if (std::count(kinds.begin(), kinds.end(), false) != 1) {
    fail("a cell has either `printed`, `says` or `shows`");
  }
  if (!spec.vacuous.empty() && (!spec.shows.empty() || !spec.hypothesis.empty())) {
    fail("`vacuous` is neither what `shows` nor a `hypothesis`");
  }
  if (!spec.says.empty() && !spec.holds.above && !spec.holds.below) {
    fail("what the text `says` holds `above` or `below` something");
  }
  return spec;
}

// Collects all {VARIABLES} in the texts of a table, including nested tables and arrays.
void collect_variables(const toml::node& node, std::vector<std::string>& names) {
  if (const auto* string = node.as_string()) {
    const std::string& text = string->get();
    for (std::size_t open = text.find('{'); open != std::string::npos;) {
      const std::size_t next = text.find_first_of("{}", open + 1);
      const bool is_name = next != std::string::npos && text[next] == '}';
      if (is_name) names.push_back(text.substr(open + 1, next - open - 1));
      open = is_name ? text.find('{', next) : next;
    }
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table) collect_variables(value, names);
  }
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& entry : *array) collect_variables(entry, names);
  }
}

// Refuses unknown keys in the cells, columns and rows of a table. Known are the keys of cells, the
// `key` of a column, and the {VARIABLES} of the texts.
void check_cell_keys(const TomlEntry& table) {
  std::vector<std::string> keys = {"title",   "key",        "run",        "metric",    "over",
                                   "divisor", "absent",     "if_failed",  "statistic", "printed",
                                   "says",    "shows",      "above",      "below",     "why",
                                   "vacuous", "hypothesis", "over_metric"};
  for (const TomlEntry& column : table["columns"].elements()) {
    if (column["key"]) keys.push_back(column["key"].text());
  }
  collect_variables(*table.node(), keys);
  table["cell"].allow(keys);
  for (const TomlEntry& column : table["columns"].elements()) column.allow(keys);
  for (const TomlEntry& row : table["rows"].elements()) {
    row.allow(keys);
    for (const auto& [key, entry] : row.entries()) {
      if (entry.node()->is_table()) entry.allow(keys);
    }
  }
}

// A cell merges the table's `cell`, its column and its row, in this order. In a row, a table with
// the name of a column's `key` is for that cell only; `false` means no cell.
TableSpec read_table(const TomlEntry& table) {
  table.allow({"title", "unit", "note", "rows", "columns", "cell"});
  check_cell_keys(table);
  const Scope scope(table);
  TableSpec spec;
  spec.title = scope.text("title");
  spec.unit = scope.text_or_nothing("unit");
  spec.note = scope.text_or_nothing("note");
  const std::vector<TomlEntry> columns = table["columns"].elements();
  for (const TomlEntry& column : columns) spec.columns.push_back(Scope(column).text("title"));
  for (const TomlEntry& row : table["rows"].elements()) {
    spec.rows.push_back(Scope(row).text("title"));
    std::vector<std::optional<CellSpec>>& cells = spec.cells.emplace_back();
    for (const TomlEntry& column : columns) {
      const TomlEntry own = row[Scope(column).text_or_nothing("key")];
      if (own && own.node()->is_boolean()) {
        cells.emplace_back();
        continue;
      }
      Scope cell(table["cell"], with(with({}, row), column));
      cell.tables.insert(cell.tables.end(), {column, row});
      if (own && own.node()->is_table()) cell.tables.push_back(own);
      cells.emplace_back(read_cell(cell));
    }
  }
  return spec;
}

std::vector<PanelSpec> read_panels(const TomlEntry& form, const Variables& variables) {
  std::vector<PanelSpec> panels;
  for (const TomlEntry& panel : form["panels"].elements()) {
    panel.allow({"title", "signals", "once", "lines", "from_s", "to_s"});
    const Scope scope(panel, variables);
    PanelSpec& spec = panels.emplace_back();
    spec.title = scope.text("title");
    spec.signals = scope.texts("signals");
    spec.once = scope.texts("once");
    for (const TomlEntry& line : panel["lines"].elements()) spec.lines.push_back(line.number());
    spec.from_s = panel["from_s"].number_or_nothing();
    spec.to_s = panel["to_s"].number_or_nothing();
  }
  return panels;
}

// Reads figures of equal form: `list` has an entry for each, `form` names their panels.
void read_figures(const TomlEntry& table, const TomlEntry& forms,
                  std::vector<FigureSpec>& figures) {
  table.allow({"form", "list", "runs"});
  const TomlEntry form = forms[table["form"].text()];
  if (!form) table["form"].fail("there is no such form");
  for (const TomlEntry& entry : table["list"].elements()) {
    const Scope scope(entry);
    const Scope labels(entry, with({}, entry));
    FigureSpec& figure = figures.emplace_back();
    figure.number = scope.text("n");
    figure.title = scope.text("title");
    figure.off = scope.texts("off");
    figure.note = scope.text_or_nothing("note");
    figure.line = entry.line();
    if (entry["run"]) figure.runs.push_back({scope.text("run"), ""});
    for (const TomlEntry& source : {table, entry}) {
      for (const TomlEntry& run : source["runs"].elements()) {
        const std::vector<TomlEntry> pair = run.elements();
        if (pair.size() != 2) run.fail("must be [NAME, LABEL] each");
        figure.runs.push_back({labels.text(pair[0]), labels.text(pair[1])});
      }
    }
    if (figure.runs.empty()) entry.fail("a figure has no run");
    figure.panels = read_panels(form, labels.variables);
  }
}

SectionSpec read_section(const TomlEntry& table, const TomlEntry& forms, Effort effort,
                         std::map<std::string, RunSpec>& runs) {
  table.allow({"id", "group", "title", "text", "docs", "video", "strip", "strip_number", "run",
               "table", "reasons", "figures", "missing"});
  const Scope scope(table);
  SectionSpec section;
  section.id = scope.text("id");
  section.group = scope.text("group");
  section.title = scope.text("title");
  section.text = scope.text_or_nothing("text");
  section.docs = scope.text_or_nothing("docs");
  section.video = scope.text_or_nothing("video");
  section.strip = scope.text_or_nothing("strip");
  section.strip_number = scope.text_or_nothing("strip_number");
  section.line = table.line();
  if (!section.docs.empty() && !look_for("docs/" + section.docs)) {
    table["docs"].fail("there is no page docs/" + section.docs);
  }
  for (const TomlEntry& run : table["run"].elements()) read_runs(run, effort, runs);
  for (const TomlEntry& one : table["table"].elements()) section.tables.push_back(read_table(one));
  for (const TomlEntry& reason : table["reasons"].elements()) {
    section.reasons.push_back({Scope(reason).text("of"), Scope(reason).text("why")});
  }
  for (const TomlEntry& figures : table["figures"].elements()) {
    read_figures(figures, forms, section.figures);
  }
  for (const TomlEntry& missing : table["missing"].elements()) {
    section.missing.push_back({Scope(missing).text("what"), Scope(missing).text("why")});
  }
  return section;
}

// Checks that all references exist.
class Check {
 public:
  Check(const Experiments& experiments, const PrintedResults& printed)
      : experiments_(experiments), printed_(printed) {}

  void all() const {
    for (const SectionSpec& section : experiments_.sections) {
      for (const std::string& name : {section.video, section.strip}) run(name, section.line);
      for (const TableSpec& table : section.tables) {
        for (const auto& row : table.cells) {
          for (const auto& cell : row) {
            if (cell) this->cell(*cell);
          }
        }
      }
      for (const FigureSpec& figure : section.figures) {
        for (const FigureRun& one : figure.runs) run(one.run, figure.line);
      }
    }
    for (const HeroSpec& hero : experiments_.heroes) this->hero(hero);
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    throw std::invalid_argument(fmt::format("{}:{}: {}", experiments_.file, line, what));
  }

  void run(const std::string& name, std::size_t line) const {
    if (name.empty() || experiments_.runs.contains(name)) return;
    std::vector<std::string> names;
    for (const auto& [known, spec] : experiments_.runs) names.push_back(known);
    fail(line, "there is no run " + name + did_you_mean(name, names));
  }

  void cell(const CellSpec& cell) const {
    for (const Quantity& quantity : cell.quantities()) run(quantity.run, cell.line);
    if (!cell.printed.empty() && !printed_.find(cell.printed)) {
      fail(cell.line, "nothing is printed at " + cell.printed);
    }
  }

  void hero(const HeroSpec& hero) const {
    for (const SectionSpec& section : experiments_.sections) {
      for (const FigureSpec& figure : section.figures) {
        if (figure.number == hero.figure && hero.panel < figure.panels.size()) return;
      }
    }
    fail(hero.line, fmt::format("there is no panel {} of a figure {}", hero.panel, hero.figure));
  }

  const Experiments& experiments_;
  const PrintedResults& printed_;
};

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) {
    names.push_back(name);
  }
}

}  // namespace

std::string Quantity::name() const {
  return is_magnitude() ? metric.substr(1, metric.size() - 2) : metric;
}

std::vector<Quantity> CellSpec::quantities() const {
  std::vector<Quantity> all = {quantity};
  if (over) all.push_back(*over);
  return all;
}

std::vector<std::string> SectionSpec::logged_runs() const {
  std::vector<std::string> names;
  for (const FigureSpec& figure : figures) {
    for (const FigureRun& run : figure.runs) add_once(names, run.run);
  }
  add_once(names, video);
  add_once(names, strip);
  return names;
}

std::vector<std::string> SectionSpec::runs() const {
  std::vector<std::string> names = logged_runs();
  for (const TableSpec& table : tables) {
    for (const auto& row : table.cells) {
      for (const auto& cell : row) {
        if (!cell) continue;
        for (const Quantity& quantity : cell->quantities()) add_once(names, quantity.run);
      }
    }
  }
  return names;
}

Experiments read_experiments(const std::string& file, Effort effort) {
  const toml::table tables = parse_toml_file(file);
  const TomlEntry root(tables, file);
  root.allow({"title", "hero", "video", "form", "section"});
  Experiments experiments;
  experiments.file = file;
  std::error_code ignored;
  experiments.is_own = !fs::equivalent(file, data_file("data/experiments.toml"), ignored);
  experiments.title = root["title"].text_or_nothing();
  experiments.video = root["video"].text_or_nothing();
  for (const TomlEntry& section : root["section"].elements()) {
    experiments.sections.push_back(read_section(section, root["form"], effort, experiments.runs));
  }
  for (const TomlEntry& hero : root["hero"].elements()) {
    const TomlEntry panel = hero["panel"];
    experiments.heroes.push_back({Scope(hero).text("figure"),
                                  static_cast<std::size_t>(panel ? panel.whole(0, kMostPanels) : 0),
                                  Scope(hero).text("caption"), hero.line()});
  }
  Check(experiments, printed_results()).all();
  return experiments;
}

}  // namespace breakwater
