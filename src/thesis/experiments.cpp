#include <breakwater/thesis/experiments.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/config/names.h>
#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/paths.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// The thesis contradicts itself or its numbers, or a result is about hardware, or a reading, metric
// or limit of ours is in doubt.
const Names<std::string> kCauses = {
    {"thesis", "thesis"}, {"hardware", "hardware"}, {"ours", "ours"}};
const Names<bool> kAbsences = {{"never", true}};
const Names<bool> kStatistics = {{"median", false}, {"share", true}};

// The number of repetitions from [full, quick].
int repetitions(const TomlEntry& entry, Effort effort) {
  constexpr std::int64_t kMostRepetitions = 1'000'000;
  const std::vector<TomlEntry> both = entry.elements();
  if (both.size() != 2) entry.fail("must be [full, quick]");
  return static_cast<int>(both[effort == Effort::full ? 0 : 1].whole(1, kMostRepetitions));
}

void read_run(const TomlEntry& row, Effort effort, std::map<std::string, RunSpec>& runs) {
  row.allow({"name", "scenario", "case", "sets", "seeds", "spread"});
  RunSpec run;
  run.name = row["name"].text();
  run.scenario = row["scenario"].text();
  run.case_name = row["case"].text();
  run.sets = row["sets"].texts();
  run.line = row.line();
  if (const TomlEntry seeds = row["seeds"]) {
    const int count = repetitions(seeds, effort);
    for (int seed = 1; seed <= count; ++seed) {
      run.repetitions.push_back({fmt::format("run.seed={}", seed)});
    }
  } else if (const TomlEntry spread = row["spread"]) {
    spread.allow({"key", "width", "count"});
    const std::string key = spread["key"].text();
    const double width = spread["width"].number();
    const int count = repetitions(spread["count"], effort);
    for (int i = 0; i < count; ++i) {
      run.repetitions.push_back(
          {fmt::format("{}={:.17g}", key, width * ((i + 0.5) / count - 0.5))});
    }
  } else {
    run.repetitions = {{}};
  }
  if (!runs.emplace(run.name, run).second) row.fail("there is a run " + run.name + " already");
}

CellSpec read_cell(const TomlEntry& cell, const std::string& reading) {
  cell.allow({"row",    "column",    "run",       "metric",  "over",    "over_metric", "divisor",
              "absent", "if_failed", "statistic", "printed", "says",    "shows",       "above",
              "below",  "why",       "cause",     "vacuous", "without", "reading"});
  CellSpec spec;
  spec.line = cell.line();
  spec.quantity = {cell["run"].text(), cell["metric"].text()};
  if (cell["over"] || cell["over_metric"]) {
    spec.over = spec.quantity;
    if (cell["over"]) spec.over->run = cell["over"].text();
    if (cell["over_metric"]) spec.over->metric = cell["over_metric"].text();
  }
  spec.divisor = cell["divisor"].number_or_nothing().value_or(1.0);
  if (spec.divisor == 0.0) cell["divisor"].fail("must not be zero");
  spec.if_failed = cell["if_failed"].number_or_nothing().value_or(spec.if_failed);
  cell["absent"].choice(kAbsences, spec.absent_is_never);
  cell["statistic"].choice(kStatistics, spec.is_share);
  spec.printed = cell["printed"].text_or_nothing();
  spec.says = cell["says"].text_or_nothing();
  spec.shows = cell["shows"].text_or_nothing();
  spec.why = cell["why"].text_or_nothing();
  cell["cause"].choice(kCauses, spec.cause);
  spec.vacuous = cell["vacuous"].text_or_nothing();
  spec.without = cell["without"].text_or_nothing();
  spec.reading = cell["reading"] ? cell["reading"].text() : reading;
  spec.holds.above = cell["above"].number_or_nothing();
  spec.holds.below = cell["below"].number_or_nothing();
  const auto kinds = {spec.printed.empty(), spec.says.empty(), spec.shows.empty()};
  if (std::count(kinds.begin(), kinds.end(), false) != 1) {
    cell.fail("a cell has either `printed`, `says` or `shows`");
  }
  if (!spec.vacuous.empty() && (!spec.shows.empty() || !spec.reading.empty())) {
    cell.fail("`vacuous` is neither what `shows` nor another `reading`");
  }
  if (!spec.without.empty() && spec.vacuous.empty()) {
    cell.fail("`without` needs `vacuous`: what it means");
  }
  if (!spec.says.empty() && !spec.holds.above && !spec.holds.below) {
    cell.fail("what the text `says` holds `above` or `below` something");
  }
  return spec;
}

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
}

// The rows of a table are those of its cells, in their order.
TableSpec read_table(const TomlEntry& table) {
  table.allow({"title", "unit", "note", "reading", "columns", "cells"});
  TableSpec spec;
  spec.title = table["title"].text();
  spec.unit = table["unit"].text_or_nothing();
  spec.note = table["note"].text_or_nothing();
  spec.columns = table["columns"].texts();
  if (spec.columns.empty()) table["columns"].fail("is missing");
  for (const TomlEntry& cell : table["cells"].elements()) {
    const std::string row = cell["row"].text();
    add_once(spec.rows, row);
    const bool has_one = spec.columns.size() == 1 && !cell["column"];
    const std::string column = has_one ? spec.columns.front() : cell["column"].text();
    if (std::ranges::find(spec.columns, column) == spec.columns.end()) {
      cell["column"].fail("there is no such column" + did_you_mean(column, spec.columns));
    }
    const auto is_there = [&](const CellSpec& other) {
      return other.row == row && other.column == column;
    };
    if (std::ranges::any_of(spec.cells, is_there)) cell.fail("there is such a cell already");
    spec.cells.push_back(read_cell(cell, table["reading"].text_or_nothing()));
    spec.cells.back().row = row;
    spec.cells.back().column = column;
  }
  return spec;
}

std::vector<PanelSpec> read_panels(const TomlEntry& form) {
  form.allow({"panels"});
  std::vector<PanelSpec> panels;
  for (const TomlEntry& panel : form["panels"].elements()) {
    panel.allow({"title", "signals", "once", "lines", "from_s", "to_s"});
    PanelSpec& spec = panels.emplace_back();
    spec.title = panel["title"].text();
    spec.signals = panel["signals"].texts();
    spec.once = panel["once"].texts();
    for (const TomlEntry& line : panel["lines"].elements()) spec.lines.push_back(line.number());
    spec.from_s = panel["from_s"].number_or_nothing();
    spec.to_s = panel["to_s"].number_or_nothing();
  }
  return panels;
}

FigureSpec read_figure(const TomlEntry& row, const TomlEntry& forms) {
  row.allow({"n", "title", "form", "run", "runs", "note"});
  FigureSpec figure;
  figure.number = row["n"].text();
  figure.title = row["title"].text();
  figure.note = row["note"].text_or_nothing();
  figure.line = row.line();
  const TomlEntry form = forms[row["form"].text()];
  if (!form) row["form"].fail("there is no such form");
  figure.panels = read_panels(form);
  if (row["run"]) figure.runs.push_back({row["run"].text(), ""});
  for (const TomlEntry& run : row["runs"].elements()) {
    const std::vector<TomlEntry> pair = run.elements();
    if (pair.size() != 2) run.fail("must be [NAME, LABEL] each");
    figure.runs.push_back({pair[0].text(), pair[1].text()});
  }
  if (figure.runs.empty()) row.fail("a figure has no run");
  return figure;
}

SectionSpec read_section(const TomlEntry& table, const TomlEntry& forms, Effort effort,
                         std::map<std::string, RunSpec>& runs) {
  table.allow({"id", "group", "title", "text", "docs", "runs", "table", "figures"});
  SectionSpec section;
  section.id = table["id"].text();
  section.group = table["group"].text();
  section.title = table["title"].text();
  section.text = table["text"].text_or_nothing();
  section.docs = table["docs"].text_or_nothing();
  if (!section.docs.empty() && !look_for("docs/" + section.docs)) {
    table["docs"].fail("there is no page docs/" + section.docs);
  }
  for (const TomlEntry& run : table["runs"].elements()) read_run(run, effort, runs);
  for (const TomlEntry& one : table["table"].elements()) section.tables.push_back(read_table(one));
  for (const TomlEntry& figure : table["figures"].elements()) {
    section.figures.push_back(read_figure(figure, forms));
  }
  return section;
}

// Adds the settings of the chosen readings to the runs.
void choose_readings(const TomlEntry& rows, const std::vector<std::string>& names,
                     Experiments& experiments) {
  std::vector<std::string> known;
  for (const TomlEntry& row : rows.elements()) {
    row.allow({"name", "runs", "sets", "why"});
    ReadingSpec reading{row["name"].text(), row["runs"].text(), row["sets"].texts(),
                        row["why"].text_or_nothing()};
    known.push_back(reading.name);
    reading.is_chosen = std::find(names.begin(), names.end(), reading.name) != names.end();
    bool has_run = false;
    for (auto& [name, run] : experiments.runs) {
      if (!matches_pattern(reading.runs, name)) continue;
      has_run = true;
      if (!reading.is_chosen) continue;
      run.sets.insert(run.sets.end(), reading.sets.begin(), reading.sets.end());
    }
    if (!has_run) row["runs"].fail("there is no run " + reading.runs);
    experiments.readings.push_back(std::move(reading));
  }
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) == known.end()) {
      throw std::invalid_argument(
          fmt::format("--reading {}: there is no such reading{}; {} has them", name,
                      did_you_mean(name, known), experiments.file));
    }
  }
}

// Checks that all references exist.
void check(const Experiments& experiments, const PrintedResults& printed) {
  const auto fail = [&](std::size_t line, const std::string& what) {
    throw std::invalid_argument(fmt::format("{}:{}: {}", experiments.file, line, what));
  };
  const auto check_run = [&](const std::string& name, std::size_t line) {
    if (name.empty() || experiments.runs.contains(name)) return;
    std::vector<std::string> names;
    for (const auto& [known, spec] : experiments.runs) names.push_back(known);
    fail(line, "there is no run " + name + did_you_mean(name, names));
  };
  for (const SectionSpec& section : experiments.sections) {
    for (const TableSpec& table : section.tables) {
      for (const CellSpec& cell : table.cells) {
        for (const Quantity& quantity : cell.quantities()) check_run(quantity.run, cell.line);
        check_run(cell.without, cell.line);
        if (!cell.printed.empty() && !printed.find(cell.printed)) {
          fail(cell.line, "nothing is printed at " + cell.printed);
        }
      }
    }
    for (const FigureSpec& figure : section.figures) {
      for (const FigureRun& one : figure.runs) check_run(one.run, figure.line);
    }
  }
}

}  // namespace

std::vector<std::string> RunSpec::sets_of(std::size_t repetition) const {
  std::vector<std::string> all = sets;
  all.insert(all.end(), repetitions[repetition].begin(), repetitions[repetition].end());
  return all;
}

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
  return names;
}

std::vector<std::string> SectionSpec::runs() const {
  std::vector<std::string> names = logged_runs();
  for (const TableSpec& table : tables) {
    for (const CellSpec& cell : table.cells) {
      for (const Quantity& quantity : cell.quantities()) add_once(names, quantity.run);
      add_once(names, cell.without);
    }
  }
  return names;
}

Experiments read_experiments(const std::string& file, Effort effort,
                             const std::vector<std::string>& readings) {
  const toml::table tables = parse_toml_file(file);
  const TomlEntry root(tables, file);
  root.allow({"title", "readings", "form", "section"});
  Experiments experiments;
  experiments.file = file;
  std::error_code ignored;
  experiments.is_own = !fs::equivalent(file, data_file("data/experiments.toml"), ignored);
  experiments.title = root["title"].text_or_nothing();
  for (const TomlEntry& section : root["section"].elements()) {
    experiments.sections.push_back(read_section(section, root["form"], effort, experiments.runs));
  }
  choose_readings(root["readings"], readings, experiments);
  check(experiments, printed_results());
  return experiments;
}

}  // namespace breakwater
