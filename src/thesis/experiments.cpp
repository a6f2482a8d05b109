#include <breakwater/thesis/experiments.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/shell/paths.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

using Variables = std::map<std::string, std::string>;

std::string place_in(const std::string& file, std::size_t line) {
  return fmt::format("{}:{}: ", file, line);
}

template <typename Place>
std::size_t line_of(const Place& place) {
  return place.source().begin.line;
}

// Tables, each on top of the one before. They are not copied into one: a copy would not know where
// in the file it stood.
class Layers {
 public:
  void add(const toml::table* table) {
    if (table != nullptr) tables_.push_back(table);
  }
  const toml::node* get(const char* key) const {
    for (std::size_t i = tables_.size(); i-- > 0;) {
      if (const toml::node* node = tables_[i]->get(key)) return node;
    }
    return nullptr;
  }
  const toml::source_region& source() const { return tables_.back()->source(); }

 private:
  std::vector<const toml::table*> tables_;
};

// A file, read piece by piece; whatever is wrong is said with its line.
class Reader {
 public:
  Reader(std::string file, Effort effort) : file_(std::move(file)), effort_(effort) {}

  template <typename Place>
  [[noreturn]] void fail(const Place& place, const std::string& what) const {
    throw std::invalid_argument(place_in(file_, line_of(place)) + what);
  }

  const toml::table& table(const toml::node& node) const {
    if (!node.is_table()) fail(node, "must be a table");
    return *node.as_table();
  }

  // `texts`: each key that is a {VARIABLE} there is allowed too.
  void allow(const toml::table& table, const std::set<std::string>& keys,
             const std::string& texts = "") const {
    for (const auto& [key, value] : table) {
      const std::string name(key.str());
      if (keys.contains(name) || texts.find("{" + name + "}") != std::string::npos) continue;
      fail(value, "there is no key " + name + did_you_mean(name, {keys.begin(), keys.end()}));
    }
  }

  template <typename Table>
  std::string text(const Table& table, const char* key, const Variables& variables) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) fail(table, fmt::format("{} is missing", key));
    return text(*node, variables);
  }

  template <typename Table>
  std::string text_or(const Table& table, const char* key, const Variables& variables) const {
    const toml::node* node = table.get(key);
    return node == nullptr ? "" : text(*node, variables);
  }

  // A text, or a number as a text.
  std::string plain(const toml::node& node) const {
    if (const auto* string = node.as_string()) return string->get();
    if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
    if (const auto* real = node.as_floating_point()) return fmt::format("{}", real->get());
    fail(node, "must be a text or a number");
  }

  // The same with each {NAME} replaced by that variable's value, which may have variables too.
  std::string text(const toml::node& node, const Variables& variables) const {
    constexpr int kMostReplacements = 100;
    std::string text = plain(node);
    for (int i = 0; text.find('{') != std::string::npos; ++i) {
      const std::size_t open = text.find('{');
      const std::size_t close = text.find('}', open);
      const std::string name = text.substr(open + 1, close - open - 1);
      const auto found = variables.find(name);
      if (close == std::string::npos || found == variables.end() || i == kMostReplacements) {
        fail(node, fmt::format("\"{}\": there is no {{{}}}", text, name));
      }
      text.replace(open, close - open + 1, found->second);
    }
    return text;
  }

  template <typename Table>
  std::optional<double> number(const Table& table, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    const auto value = node->value<double>();
    if (!value || !std::isfinite(*value)) fail(*node, fmt::format("{} must be a number", key));
    return value;
  }

  // From 0 on; 0 if the key is not there.
  std::size_t count(const toml::table& table, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return 0;
    const auto* integer = node->as_integer();
    if (integer == nullptr || integer->get() < 0)
      fail(*node, fmt::format("{} must be 0 or more", key));
    return static_cast<std::size_t>(integer->get());
  }

  // One of `words`; empty if the key is not there.
  template <typename Table>
  std::string word_or(const Table& table, const char* key,
                      const std::vector<std::string>& words) const {
    std::string word = text_or(table, key, {});
    if (!word.empty() && std::find(words.begin(), words.end(), word) == words.end()) {
      fail(*table.get(key),
           fmt::format("{}: \"{}\" must be {}", key, word, fmt::join(words, " or ")));
    }
    return word;
  }

  // A number that may be written with variables.
  double real(const toml::table& table, const char* key, const Variables& variables) const {
    const std::string written = text(table, key, variables);
    double value = 0.0;
    const auto [end, error] =
        std::from_chars(written.data(), written.data() + written.size(), value);
    if (error != std::errc() || end != written.data() + written.size() || !std::isfinite(value)) {
      fail(*table.get(key), fmt::format("{}: \"{}\" is no number", key, written));
    }
    return value;
  }

  std::vector<std::string> texts(const toml::table& table, const char* key,
                                 const Variables& variables) const {
    std::vector<std::string> all;
    each(table, key, [&](const toml::node& node) { all.push_back(text(node, variables)); });
    return all;
  }

  // Calls `body` for each entry of an array that may be missing.
  template <typename Body>
  void each(const toml::table& table, const char* key, Body&& body) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return;
    if (!node->is_array()) fail(*node, fmt::format("{} must be an array", key));
    for (const toml::node& entry : *node->as_array()) body(entry);
  }

  // The texts and numbers of a table, on top of others.
  Variables with(Variables variables, const toml::table& more) const {
    for (const auto& [key, value] : more) {
      const bool is_plain = value.is_string() || value.is_number();
      if (is_plain) variables[std::string(key.str())] = plain(value);
    }
    return variables;
  }

  // The combinations of the lists `for`, `and`: one without variables if there are none.
  std::vector<Variables> combinations(const toml::table& table) const {
    std::vector<Variables> all = {{}};
    for (const char* key : {"for", "and"}) {
      if (!table.contains(key)) continue;
      std::vector<Variables> longer;
      for (const Variables& variables : all) {
        each(table, key, [&](const toml::node& entry) {
          longer.push_back(with(variables, this->table(entry)));
        });
      }
      all = longer;
    }
    return all;
  }

  // [of the full effort, of the quick one].
  int repetitions(const toml::table& table, const char* key) const {
    const toml::node* node = table.get(key);
    const toml::array* both = node->as_array();
    if (both == nullptr || both->size() != 2) fail(*node, fmt::format("{}: [full, quick]", key));
    const auto count = (*both)[effort_ == Effort::full ? 0 : 1].value<int>();
    if (!count || *count < 1) fail(*node, fmt::format("{} must be positive", key));
    return *count;
  }

 private:
  std::string file_;
  Effort effort_;
};

void read_runs(const Reader& reader, const toml::table& table,
               std::map<std::string, RunSpec>& runs) {
  reader.allow(table,
               {"name", "scenario", "case", "sets", "for", "and", "seeds", "spread", "except"});
  for (const Variables& variables : reader.combinations(table)) {
    RunSpec run;
    run.name = reader.text(table, "name", variables);
    run.scenario = reader.text(table, "scenario", variables);
    run.case_name = reader.text(table, "case", variables);
    run.sets = reader.texts(table, "sets", variables);
    run.line = line_of(table);
    if (table.contains("seeds")) {
      const int seeds = reader.repetitions(table, "seeds");
      for (int seed = 1; seed <= seeds; ++seed) {
        run.repetitions.push_back({fmt::format("run.seed={}", seed)});
      }
    } else if (const toml::node* spread = table.get("spread")) {
      const toml::table& over = reader.table(*spread);
      reader.allow(over, {"key", "width", "count"});
      const std::string key = reader.text(over, "key", variables);
      const double width = reader.real(over, "width", variables);
      const int count = width > 0.0 ? reader.repetitions(over, "count") : 1;
      for (int i = 0; i < count; ++i) {
        run.repetitions.push_back(
            {fmt::format("{}={:.17g}", key, width * ((i + 0.5) / count - 0.5))});
      }
    } else {
      run.repetitions = {{}};
    }
    if (!runs.emplace(run.name, run).second) {
      reader.fail(table, "there is a run " + run.name + " already");
    }
  }
}

Band read_holds(const Reader& reader, const Layers& cell) {
  Band band;
  band.above = reader.number(cell, "above");
  band.below = reader.number(cell, "below");
  return band;
}

CellSpec read_cell(const Reader& reader, const Layers& cell, const Variables& variables) {
  CellSpec spec;
  spec.line = line_of(cell);
  spec.quantity = {reader.text(cell, "run", variables), reader.text(cell, "metric", variables)};
  if (cell.get("over") != nullptr || cell.get("over_metric") != nullptr) {
    spec.over = spec.quantity;
    if (cell.get("over") != nullptr) spec.over->run = reader.text(cell, "over", variables);
    if (cell.get("over_metric") != nullptr) {
      spec.over->metric = reader.text(cell, "over_metric", variables);
    }
  }
  spec.divisor = reader.number(cell, "divisor").value_or(1.0);
  if (spec.divisor == 0.0) reader.fail(*cell.get("divisor"), "divisor must not be zero");
  spec.if_failed = reader.number(cell, "if_failed").value_or(spec.if_failed);
  spec.absent_is_never = reader.word_or(cell, "absent", {"never"}) == "never";
  spec.is_share = reader.word_or(cell, "statistic", {"median", "share"}) == "share";
  spec.printed = reader.text_or(cell, "printed", variables);
  spec.says = reader.text_or(cell, "says", variables);
  spec.shows = reader.text_or(cell, "shows", variables);
  spec.why = reader.text_or(cell, "why", variables);
  spec.vacuous = reader.text_or(cell, "vacuous", variables);
  spec.hypothesis = reader.text_or(cell, "hypothesis", variables);
  spec.holds = read_holds(reader, cell);
  const auto kinds = {spec.printed.empty(), spec.says.empty(), spec.shows.empty()};
  if (std::count(kinds.begin(), kinds.end(), false) != 1) {
    reader.fail(cell, "a cell has either `printed`, `says` or `shows`");
  }
  if (!spec.vacuous.empty() && (!spec.shows.empty() || !spec.hypothesis.empty())) {
    reader.fail(cell, "`vacuous` is neither what `shows` nor a `hypothesis`");
  }
  if (!spec.says.empty() && !spec.holds.above && !spec.holds.below) {
    reader.fail(cell, "what the text `says` holds `above` or `below` something");
  }
  return spec;
}

// All texts in a table and in the tables and arrays in it, one after the other.
void collect_texts(const toml::node& node, std::string& texts) {
  if (const auto* string = node.as_string()) texts += string->get() + "\n";
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table) collect_texts(value, texts);
  }
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& entry : *array) collect_texts(entry, texts);
  }
}

// Refuses a key of a table's cells, columns and rows that is none of a cell's, no column's `key`
// and no {VARIABLE} of any text there.
void check_cell_keys(const Reader& reader, const toml::table& table) {
  std::set<std::string> keys = {"title",   "key",        "run",        "metric",    "over",
                                "divisor", "absent",     "if_failed",  "statistic", "printed",
                                "says",    "shows",      "above",      "below",     "why",
                                "vacuous", "hypothesis", "over_metric"};
  reader.each(table, "columns", [&](const toml::node& column) {
    keys.insert(reader.text_or(reader.table(column), "key", {}));
  });
  std::string texts;
  collect_texts(table, texts);
  const auto check = [&](const toml::node& node) { reader.allow(reader.table(node), keys, texts); };
  if (const toml::node* common = table.get("cell")) check(*common);
  reader.each(table, "columns", check);
  reader.each(table, "rows", [&](const toml::node& row) {
    check(row);
    for (const auto& [key, value] : reader.table(row)) {
      if (value.is_table()) check(value);
    }
  });
}

// A cell is what the table's `cell` says, then what its column and its row say. A row may have a
// table named like a column's `key`, for that cell alone; `false` there means that there is none.
TableSpec read_table(const Reader& reader, const toml::table& table) {
  reader.allow(table, {"title", "unit", "note", "rows", "columns", "cell"});
  check_cell_keys(reader, table);
  TableSpec spec;
  spec.title = reader.text(table, "title", {});
  spec.unit = reader.text_or(table, "unit", {});
  spec.note = reader.text_or(table, "note", {});
  reader.each(table, "columns", [&](const toml::node& column) {
    spec.columns.push_back(reader.text(reader.table(column), "title", {}));
  });
  reader.each(table, "rows", [&](const toml::node& row_node) {
    const toml::table& row = reader.table(row_node);
    spec.rows.push_back(reader.text(row, "title", {}));
    std::vector<std::optional<CellSpec>> cells;
    reader.each(table, "columns", [&](const toml::node& column_node) {
      const toml::table& column = reader.table(column_node);
      const toml::node* own = row.get(reader.text_or(column, "key", {}));
      if (own != nullptr && own->is_boolean()) {
        cells.emplace_back();
        return;
      }
      Layers cell;
      if (const toml::node* common = table.get("cell")) cell.add(&reader.table(*common));
      cell.add(&column);
      cell.add(&row);
      if (own != nullptr) cell.add(own->as_table());
      const Variables variables = reader.with(reader.with({}, row), column);
      cells.emplace_back(read_cell(reader, cell, variables));
    });
    spec.cells.push_back(cells);
  });
  return spec;
}

std::vector<PanelSpec> read_panels(const Reader& reader, const toml::table& table,
                                   const Variables& variables) {
  std::vector<PanelSpec> panels;
  reader.each(table, "panels", [&](const toml::node& node) {
    const toml::table& panel = reader.table(node);
    reader.allow(panel, {"title", "signals", "once", "lines", "from_s", "to_s"});
    PanelSpec spec;
    spec.title = reader.text(panel, "title", variables);
    spec.signals = reader.texts(panel, "signals", variables);
    spec.once = reader.texts(panel, "once", variables);
    reader.each(panel, "lines",
                [&](const toml::node& line) { spec.lines.push_back(line.value_or(0.0)); });
    spec.from_s = reader.number(panel, "from_s");
    spec.to_s = reader.number(panel, "to_s");
    panels.push_back(spec);
  });
  return panels;
}

// Figures of one form: `list` has one entry each, `form` names their panels.
void read_figures(const Reader& reader, const toml::table& table, const toml::table& forms,
                  std::vector<FigureSpec>& figures) {
  reader.allow(table, {"form", "list", "runs"});
  const toml::table* form = forms[reader.text(table, "form", {})].as_table();
  if (form == nullptr) reader.fail(*table.get("form"), "there is no such form");
  reader.each(table, "list", [&](const toml::node& node) {
    const toml::table& entry = reader.table(node);
    const Variables variables = reader.with({}, entry);
    FigureSpec figure;
    figure.number = reader.text(entry, "n", {});
    figure.title = reader.text(entry, "title", {});
    figure.off = reader.texts(entry, "off", {});
    figure.note = reader.text_or(entry, "note", {});
    figure.line = line_of(entry);
    if (entry.contains("run")) figure.runs.push_back({reader.text(entry, "run", {}), ""});
    for (const toml::table* source : {&table, &entry}) {
      reader.each(*source, "runs", [&](const toml::node& run) {
        const toml::array* pair = run.as_array();
        if (pair == nullptr || pair->size() != 2) reader.fail(run, "runs: [NAME, LABEL] each");
        figure.runs.push_back(
            {reader.text((*pair)[0], variables), reader.text((*pair)[1], variables)});
      });
    }
    if (figure.runs.empty()) reader.fail(entry, "a figure has no run");
    figure.panels = read_panels(reader, *form, variables);
    figures.push_back(figure);
  });
}

SectionSpec read_section(const Reader& reader, const toml::table& table, const toml::table& forms,
                         std::map<std::string, RunSpec>& runs) {
  reader.allow(table, {"id", "group", "title", "text", "docs", "video", "strip", "strip_number",
                       "run", "table", "reasons", "figures", "missing"});
  SectionSpec section;
  section.id = reader.text(table, "id", {});
  section.group = reader.text(table, "group", {});
  section.title = reader.text(table, "title", {});
  section.text = reader.text_or(table, "text", {});
  section.docs = reader.text_or(table, "docs", {});
  section.video = reader.text_or(table, "video", {});
  section.strip = reader.text_or(table, "strip", {});
  section.strip_number = reader.text_or(table, "strip_number", {});
  section.line = line_of(table);
  if (!section.docs.empty() && !look_for("docs/" + section.docs)) {
    reader.fail(*table.get("docs"), "there is no page docs/" + section.docs);
  }
  reader.each(table, "run",
              [&](const toml::node& node) { read_runs(reader, reader.table(node), runs); });
  reader.each(table, "table", [&](const toml::node& node) {
    section.tables.push_back(read_table(reader, reader.table(node)));
  });
  reader.each(table, "reasons", [&](const toml::node& node) {
    const toml::table& reason = reader.table(node);
    section.reasons.push_back({reader.text(reason, "of", {}), reader.text(reason, "why", {})});
  });
  reader.each(table, "figures", [&](const toml::node& node) {
    read_figures(reader, reader.table(node), forms, section.figures);
  });
  reader.each(table, "missing", [&](const toml::node& node) {
    const toml::table& missing = reader.table(node);
    section.missing.push_back({reader.text(missing, "what", {}), reader.text(missing, "why", {})});
  });
  return section;
}

// Everything that is referred to is there.
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
    throw std::invalid_argument(place_in(experiments_.file, line) + what);
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
  const toml::table root = parse_toml_file(file);
  const Reader reader(file, effort);
  reader.allow(root, {"title", "hero", "video", "form", "section"});
  Experiments experiments;
  experiments.file = file;
  std::error_code ignored;
  experiments.is_own = !fs::equivalent(file, data_file("data/experiments.toml"), ignored);
  experiments.title = reader.text_or(root, "title", {});
  experiments.video = reader.text_or(root, "video", {});
  const toml::table no_forms;
  const toml::table* forms = root["form"].as_table();
  reader.each(root, "section", [&](const toml::node& node) {
    experiments.sections.push_back(read_section(
        reader, reader.table(node), forms == nullptr ? no_forms : *forms, experiments.runs));
  });
  reader.each(root, "hero", [&](const toml::node& node) {
    const toml::table& hero = reader.table(node);
    experiments.heroes.push_back({reader.text(hero, "figure", {}), reader.count(hero, "panel"),
                                  reader.text(hero, "caption", {}), line_of(hero)});
  });
  Check(experiments, printed_results()).all();
  return experiments;
}

}  // namespace breakwater
