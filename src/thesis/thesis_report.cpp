#include <breakwater/thesis/thesis_report.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <ranges>
#include <set>
#include <stdexcept>
#include <tuple>

#include <breakwater/config/config.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/signal_charts.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/result_row.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// The runs of one section's figures.
using Logs = std::map<std::string, SavedRun>;

// A panel of a figure. One with its own time window has its own time axis.
PageChart chart_of(const FigureSpec& figure, const PanelSpec& panel, const Logs& logs) {
  PageChart chart;
  chart.title = panel.title;
  chart.lines = panel.lines;
  const double from_s = panel.from_s.value_or(std::numeric_limits<double>::lowest());
  const double to_s = panel.to_s.value_or(std::numeric_limits<double>::max());
  const auto add = [&](const FigureRun& run, const std::string& signal, bool has_name) {
    const SavedRun& saved = logs.at(run.run);
    const std::string label =
        has_name && !run.label.empty() ? run.label + ", " + signal : run.label;
    ChartSeries series = series_of(saved, signal, label.empty() ? signal : label);
    series.values = cut(series.values, from_s, to_s);
    return &chart.series.emplace_back(std::move(series));
  };
  for (const std::string& signal : panel.once) {
    add({figure.runs.front().run, ""}, signal, true)->style =
        role_of_signal(signal).value_or(kReferenceStyle);
  }
  for (const FigureRun& run : figure.runs) {
    for (const std::string& signal : panel.signals) {
      ChartSeries* const series = add(run, signal, panel.signals.size() > 1);
      // If a figure has several runs, each has its own colour.
      if (figure.runs.size() == 1) series->style = role_of_signal(signal);
    }
  }
  return chart;
}

auto vacuous_of(const std::vector<JudgedCell>& cells) {
  return std::ranges::count_if(
      cells, [](const JudgedCell& one) { return one.judged.verdict == Verdict::vacuous; });
}

PageData tallies_data(const std::vector<JudgedCell>& cells) {
  auto list = PageData::array();
  for (const Tally& tally : tallies(cells)) {
    list.push_back(
        {{"kind", css_class(tally.verdict)}, {"count", tally.count}, {"word", tally.word}});
  }
  return list;
}

// How the values of several runs differ.
std::string spread_text(const Judged& judged) {
  if (judged.numbers < judged.values || judged.values < 2) return "";
  return fmt::format("{} to {} in {} runs", in_digits(judged.smallest), in_digits(judged.largest),
                     judged.values);
}

// The place of a text in a list, counted from one; a new one goes to its end.
std::size_t number_in(std::vector<std::string>& list, const std::string& text) {
  auto place = std::find(list.begin(), list.end(), text);
  if (place == list.end()) place = list.insert(list.end(), text);
  return static_cast<std::size_t>(place - list.begin()) + 1;
}

// A measured number beside the printed one, and its verdict. `notes` gets the reason.
PageData cell_data(const JudgedCell& one, std::vector<std::string>& notes) {
  const CellSpec& cell = one.cell;
  const Judged& judged = one.judged;
  auto lines = PageData::array();
  const auto add = [&](const std::string& kind, const std::string& text) {
    if (!text.empty()) lines.push_back({{"text", text}, {"kind", kind}});
  };
  if (!cell.printed.empty()) add("printed", "thesis " + judged.printed);
  add("spread", spread_text(judged));
  if (!cell.says.empty()) add("printed", judged.class_text);
  if (cell.shows.empty()) {
    add("verdict " + css_class(judged.verdict), one.word());
    lines.back()["tip"] = judged.class_text;
  } else {
    add("printed", "beside the rest, not judged");
  }
  const std::string why = reason_of(judged, cell);
  if (!why.empty()) add("note", std::to_string(number_in(notes, why)));
  return {{"says", cell.says + cell.shows}, {"value", judged.measured}, {"lines", lines}};
}

// Judges the cells of a table, which go to `cells`, and shows them.
void add_table(const SectionSpec& section, const TableSpec& table, const Measured& measured,
               bool is_own, std::vector<JudgedCell>& cells, PageData& blocks) {
  std::vector<std::string> notes, classes;
  PageData columns = PageData::array({table.unit.empty() ? "" : "[" + table.unit + "]"});
  for (const std::string& column : table.columns) columns.push_back(column);
  auto rows = PageData::array();
  for (const std::string& row : table.rows) {
    rows.push_back(PageData::array({row}));
    for (const std::string& column : table.columns) {
      rows.back().push_back("");
      for (const CellSpec& cell : table.cells) {
        if (cell.row != row || cell.column != column) continue;
        cells.push_back(
            {section.id, table.title, cell, judge_cell(cell, measured, printed_results()), is_own});
        rows.back().back() = cell_data(cells.back(), notes);
        if (!cell.printed.empty()) number_in(classes, cells.back().judged.class_text);
      }
    }
  }
  add_block(blocks, "subheading", table.title);
  add_block(blocks, "table",
            {{"label", table.title}, {"kind", "measured"}, {"columns", columns}, {"rows", rows}});
  add_block(blocks, "text", table.note);
  if (!classes.empty()) {
    add_block(blocks, "text", fmt::format("Judged by: {}", fmt::join(classes, " · ")));
  }
  auto list = PageData::array();
  for (const std::string& why : notes) list.push_back(PageData{{"text", why}});
  blocks.push_back({{"list", list}, {"kind", "notes"}});
}

PageData figure_data(const FigureSpec& figure, const SectionSpec& section, const Logs& logs) {
  auto charts = PageData::array();
  for (const PanelSpec& panel : figure.panels) {
    PageChart chart = chart_of(figure, panel, logs);
    chart.id = fmt::format("figure-{}-{}", anchor(figure.number), charts.size() + 1);
    chart.group = "section-" + anchor(section.id);
    if (panel.from_s || panel.to_s) chart.axis = chart.id;
    charts.push_back(chart.json());
  }
  std::string note = figure.note;
  for (const FigureRun& run : figure.runs) {
    if (const auto& failure = logs.at(run.run).failure()) {
      note += fmt::format(" {} fails at {:.4g} s: {}.", run.run, failure->time_s, failure->reason);
    }
  }
  return {{"id", "figure-" + anchor(figure.number)},
          {"number", figure.number},
          {"caption", figure.title},
          {"charts", charts},
          {"note", note}};
}

// A line of verdicts.csv. Numbers have all digits.
ResultRow row_of(const JudgedCell& one) {
  const auto& [section, table, cell, judged, is_own] = one;
  const Quantity over = cell.over.value_or(Quantity{});
  ResultRow row;
  const auto put_exact = [&row](const char* column, double value) {
    row.put(column, std::isnan(value) ? "" : fmt::format("{}", value));
  };
  row.put("section", section);
  row.put("table", table);
  row.put("row", cell.row);
  row.put("column", cell.column);
  row.put("run", cell.quantity.run);
  row.put("metric", cell.quantity.metric);
  row.put("over_run", over.run);
  row.put("over_metric", over.metric);
  put_exact("divisor", cell.divisor);
  row.put("statistic", cell.is_share ? "share" : "median");
  put_exact("measured", judged.median);
  put_exact("smallest", judged.numbers > 0 ? judged.smallest : std::nan(""));
  put_exact("largest", judged.numbers > 0 ? judged.largest : std::nan(""));
  row.put("runs", std::to_string(judged.values));
  row.put("printed", cell.printed.empty() ? "" : judged.printed);
  row.put("says", cell.says + cell.shows);
  row.put("holds_if", judged.class_text);
  row.put("verdict", one.word());
  row.put("cause", judged.verdict == Verdict::not_reproduced ? cell.cause : "");
  row.put("why", reason_of(judged, cell));
  return row;
}

std::string verdict_list(const std::vector<JudgedCell>& cells) {
  std::vector<ResultRow> rows;
  std::ranges::transform(cells, std::back_inserter(rows), row_of);
  return csv_table(row_of({}).columns(), rows);
}

// Charts of a section, from the logs of its runs.
void add_figures(const Reproduction& reproduction, const SectionSpec& section, PageData& blocks) {
  Logs logs;
  for (const std::string& run : section.logged_runs()) {
    logs.try_emplace(run, run_folder(reproduction.out, run));
  }
  auto figures = PageData::array();
  for (const FigureSpec& figure : section.figures) {
    figures.push_back(figure_data(figure, section, logs));
  }
  add_block(blocks, "figures", figures);
}

// The effort, and the results of all sections.
PageData lead_of(const Experiments& experiments, Effort effort,
                 const std::vector<JudgedCell>& cells) {
  std::string extent =
      effort == Effort::quick
          ? "This is the quick version: fewer seeds and encoder phases than the full one."
          : "This is the full version, with all seeds and encoder phases.";
  for (const ReadingSpec& reading : experiments.readings) {
    if (!reading.is_chosen) continue;
    extent += fmt::format(" Other reading {}: {} with {}. {}", reading.name, reading.runs,
                          fmt::join(reading.sets, " "), reading.why);
  }
  auto lead = PageData::array(), list = PageData::array();
  add_block(lead, "about",
            experiments.is_own
                ? extent
                : "Every experiment of the thesis “Robust Model-based Control in Motion Control "
                  "Systems”, run in MuJoCo. Each printed number, verdict and figure stands "
                  "beside the one measured here. " +
                      extent);
  if (!experiments.is_own) {
    for (const std::string& line : headline(cells)) list.push_back(PageData{{"text", line}});
  }
  add_block(lead, "list", list);
  add_block(lead, "score", tallies_data(cells));
  if (const auto vacuous = vacuous_of(cells); vacuous > 0) {
    add_block(lead, "text",
              fmt::format("Beside these, and not counted among them: {} vacuous, which hold by "
                          "construction. Other readings than a section's stand in its tables; "
                          "their notes say which, and no count has them.",
                          vacuous));
  }
  add_block(lead, "text",
            fmt::format("The criterion of a result stands below its table, and at its verdict{}. "
                        "A random result is the median of its runs.",
                        experiments.is_own
                            ? ""
                            : ". data/reproduced.toml has all, and "
                              "docs/how-to/reproducing-the-thesis.md says which were chosen with "
                              "the results known"));
  return lead;
}

// The page with all results. Reads logs from OUT/runs. `cells` gets those of its tables, in their
// order.
std::string thesis_page(const Reproduction& reproduction, const Measured& measured, Effort effort,
                        std::vector<JudgedCell>& cells) {
  const Experiments& experiments = reproduction.experiments;
  const bool is_own = experiments.is_own;
  auto sections = PageData::array();
  for (const SectionSpec* spec : reproduction.sections) {
    auto blocks = PageData::array();
    add_block(blocks, "paragraph", spec->text);
    add_block(
        blocks, "text",
        fmt::format(
            "{}This section alone: breakwater reproduce --only {}",
            spec->docs.empty() ? "" : "Method, readings and deviations: docs/" + spec->docs + ". ",
            spec->id));
    for (const TableSpec& table : spec->tables) {
      add_table(*spec, table, measured, is_own, cells, blocks);
    }
    add_figures(reproduction, *spec, blocks);
    add_section(sections, "section-" + anchor(spec->id), spec->title, blocks);
    sections.back()["number"] = spec->id;
  }
  const std::string title = experiments.title.empty() ? "Experiments" : experiments.title;
  return html_page("thesis", {{"title", is_own ? title : "The thesis, reproduced"},
                              {"lead", lead_of(experiments, effort, cells)},
                              {"sections", sections}});
}

constexpr std::ptrdiff_t kMostFailures = 15;  // in a terminal; the page has all

struct ReproduceArguments {
  std::string only = "all";
  std::string out = "runs/reproduce";
  std::string file;
  std::vector<std::string> readings;
  bool quick = false;
  bool quiet = false;
};

// The sections of a group, or all whose number begins with `only`: "2.4" selects 2.4.3.2.
std::vector<const SectionSpec*> choose_sections(const Experiments& experiments,
                                                const std::string& only) {
  std::vector<const SectionSpec*> chosen;
  std::vector<std::string> names;
  std::set<std::string> groups;
  for (const SectionSpec& section : experiments.sections) {
    names.push_back(section.id);
    names.push_back(section.group);
    groups.insert(section.group);
    if (only == "all" || only == section.group || only == section.id ||
        section.id.starts_with(only + ".")) {
      chosen.push_back(&section);
    }
  }
  if (chosen.empty()) {
    throw std::invalid_argument(fmt::format(
        "--only {}: must be all, {} or a section, such as {}{}", only, fmt::join(groups, ", "),
        experiments.sections.front().id, did_you_mean(only, names)));
  }
  return chosen;
}

// A reading that changes no run of the chosen sections is a mistake.
void check_readings(const ReproduceArguments& arguments, const Experiments& experiments,
                    const std::vector<const SectionSpec*>& chosen) {
  for (const std::string& name : arguments.readings) {
    std::vector<std::string> changed;
    bool is_heeded = false;
    const auto changes = [&](const std::string& run) {
      return std::ranges::any_of(experiments.readings, [&](const ReadingSpec& reading) {
        return reading.name == name && matches_pattern(reading.runs, run);
      });
    };
    for (const SectionSpec& section : experiments.sections) {
      if (!std::ranges::any_of(section.runs(), changes)) continue;
      changed.push_back(section.id);
      is_heeded |= std::ranges::find(chosen, &section) != chosen.end();
    }
    if (is_heeded) continue;
    throw std::invalid_argument(
        fmt::format("--reading {}: changes no run of --only {}, but runs of the sections {}", name,
                    arguments.only, fmt::join(changed, ", ")));
  }
}

// Refuses a folder with contents that are not ours.
void check_out(const fs::path& out) {
  if (!fs::exists(out)) return;
  if (!fs::is_directory(out))
    throw std::invalid_argument(out.string() + ": is a file, not a folder");
  const bool is_study = fs::exists(out / "study.toml");  // a study of `sweep` has shards too
  if (!fs::is_empty(out) && (!fs::exists(shards_folder(out)) || is_study)) {
    throw std::invalid_argument(out.string() +
                                ": holds something that is not a reproduction; give another --out");
  }
}

int reproduce(const Catalogue& catalogue, const ReproduceArguments& arguments) {
  const fs::path file =
      arguments.file.empty() ? data_file("data/experiments.toml") : fs::path(arguments.file);
  const Effort effort = arguments.quick ? Effort::quick : Effort::full;
  const Experiments experiments = read_experiments(file.string(), effort, arguments.readings);
  const std::vector<const SectionSpec*> sections = choose_sections(experiments, arguments.only);
  check_readings(arguments, experiments, sections);
  check_out(arguments.out);
  stop_on_signals();
  const Reproduction reproduction{catalogue,     experiments,     sections,
                                  arguments.out, arguments.quiet, &interrupted()};
  const Measured measured = measure(reproduction);
  std::vector<JudgedCell> cells;
  const std::string html = thesis_page(reproduction, measured, effort, cells);
  const fs::path page = reproduction.out / "report.html", csv = reproduction.out / "verdicts.csv";
  replace_file(page, html);
  replace_file(csv, verdict_list(cells));
  if (!experiments.is_own) {
    for (const std::string& line : headline(cells)) fmt::print("{}\n", line);
  }
  if (!arguments.readings.empty()) {
    fmt::print("other readings: {}; a reason is that of the shipped one unless it names another\n",
               fmt::join(arguments.readings, ", "));
  }
  const auto has_failed = [](const JudgedCell& one) {
    return one.is_counted() && one.judged.verdict == Verdict::not_reproduced;
  };
  const auto failures = std::ranges::count_if(cells, has_failed);
  if (failures > 0 && failures <= kMostFailures) {
    fmt::print("{}:\n", experiments.is_own ? "did not hold" : "not reproduced");
    for (const JudgedCell& one : cells | std::views::filter(has_failed)) {
      fmt::print("  {}, {}, {}: {}, {} ({})\n", one.section, one.cell.row, one.cell.column,
                 one.judged.measured, one.judged.printed, one.judged.class_text);
    }
  }
  fmt::print("{}\nreport: {}\nverdicts: {}\n", score_text(cells), page.string(), csv.string());
  return kSuccess;
}

int reproduce_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  CLI::App app(
      own_program_name() +
          " reproduce: run every experiment of the thesis, and put its results beside the printed "
          "ones.",
      "reproduce");
  ReproduceArguments arguments;
  app.add_option("--only", arguments.only,
                 "all, arm, cart, motor, quadrotor or a section of the thesis")
      ->type_name("WHAT");
  app.add_flag("--quick", arguments.quick, "fewer seeds and encoder phases");
  app.add_option("--out", arguments.out, "where runs and report.html go")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--experiments", arguments.file,
                 "another list of experiments than data/experiments.toml")
      ->type_name("FILE");
  app.add_option("--reading", arguments.readings,
                 "other readings of the text, by their names in the list of experiments")
      ->type_name("NAME[,NAME]")
      ->delimiter(',');
  app.add_flag("--quiet", arguments.quiet, "print errors and the score only");
  app.footer(
      "Results of the same configuration, models and program are kept, so an interrupted\n"
      "reproduction continues. data/reproduced.toml has the criteria.\n"
      "Exit status: 0 success, 1 a defect, 2 usage or input, 130 interrupted.");
  if (const auto status = parse(app, argc, argv)) return *status;
  return reproduce(catalogue, arguments);
}

}  // namespace

std::string JudgedCell::word() const {
  if (judged.verdict == Verdict::shown) return text(judged.verdict);
  const std::string before = cell.reading.empty() ? "" : "other reading: ";
  // A statement of a user's own list holds; it is not reproduced.
  const bool is_own_statement = is_own && !cell.says.empty();
  if (is_own_statement && judged.verdict == Verdict::reproduced) return before + "holds";
  if (is_own_statement && judged.verdict == Verdict::not_reproduced) {
    return before + "does not hold";
  }
  return before + text(judged.verdict);
}

std::string reason_of(const Judged& judged, const CellSpec& cell) {
  if (!cell.reading.empty()) return cell.reading;
  if (judged.verdict == Verdict::vacuous) return cell.vacuous;
  if (judged.verdict == Verdict::shown || judged.verdict == Verdict::reproduced) return "";
  return cell.why;
}

std::vector<Tally> tallies(const std::vector<JudgedCell>& cells) {
  std::map<std::string, int> counts;
  for (const JudgedCell& one : cells) ++counts[one.word()];
  const bool has_own = counts["holds"] + counts["does not hold"] > 0;
  const bool has_printed =
      counts["reproduced"] + counts["within the class"] + counts["not reproduced"] > 0;
  std::vector<Tally> all;
  const auto add = [&](bool is_shown, const char* word, const char* in_list, Verdict verdict) {
    if (is_shown) all.push_back({counts[in_list], word, verdict});
  };
  for (const Verdict verdict :
       {Verdict::reproduced, Verdict::within_class, Verdict::not_reproduced}) {
    add(has_printed || !has_own, text(verdict).c_str(), text(verdict).c_str(), verdict);
  }
  add(has_own, "held", "holds", Verdict::reproduced);
  add(has_own, "did not hold", "does not hold", Verdict::not_reproduced);
  add(counts["not measured"] > 0, "not measured", "not measured", Verdict::not_measured);
  return all;
}

std::string score_text(const std::vector<JudgedCell>& cells) {
  std::vector<std::string> parts;
  for (const Tally& tally : tallies(cells)) {
    parts.push_back(fmt::format("{} {}", tally.count, tally.word));
  }
  const auto vacuous = vacuous_of(cells);
  return fmt::format("{}{}", fmt::join(parts, ", "),
                     vacuous > 0 ? fmt::format("; beside them {} vacuous", vacuous) : "");
}

std::vector<std::string> headline(const std::vector<JudgedCell>& cells) {
  using Counts = std::map<Verdict, int>;
  Counts printed;
  std::map<std::string, Counts> statements;  // the cells of each statement of each section
  std::map<std::string, int> causes;
  int numbers = 0, near = 0, fair = 0;
  for (const JudgedCell& one : cells) {
    if (!one.is_counted()) continue;
    const auto& [cell, judged] = std::tie(one.cell, one.judged);
    ++(cell.printed.empty() ? statements[one.section + ": " + cell.says] : printed)[judged.verdict];
    if (judged.deviation) {
      ++numbers;
      near += *judged.deviation <= 0.05 ? 1 : 0;
      fair += *judged.deviation <= 0.25 ? 1 : 0;
    }
    if (judged.verdict == Verdict::not_reproduced) {
      ++causes[cell.cause.empty() ? "not said" : cell.cause];
    }
  }
  // All but the vacuous ones.
  const auto counted = [](const Counts& counts) {
    int sum = 0;
    for (const auto& [verdict, count] : counts) sum += verdict == Verdict::vacuous ? 0 : count;
    return sum;
  };
  std::vector<std::string> lines;
  if (!printed.empty()) {
    const int judged = counted(printed), vacuous = printed[Verdict::vacuous];
    const int reproduced = printed[Verdict::reproduced], within = printed[Verdict::within_class];
    lines.push_back(fmt::format(
        "printed results: {} of {} reproduced, {} within their class, {} not, {} vacuous",
        reproduced, judged + vacuous, within, judged - reproduced - within, vacuous));
  }
  if (numbers > 0) {
    lines.push_back(
        fmt::format("printed numbers: {} of {} within 5 %, {} within 25 %", near, numbers, fair));
  }
  int whole = 0, none = 0, judged = 0, all = 0;
  for (auto& [statement, counts] : statements) {
    const int of_it = counted(counts), reproduced = counts[Verdict::reproduced];
    if (of_it == 0) continue;
    all += of_it;
    ++judged;
    whole += reproduced == of_it ? 1 : 0;
    none += reproduced == 0 ? 1 : 0;
  }
  if (judged > 0) {
    lines.push_back(
        fmt::format("different statements ({} cells): {} of {} hold in all cells, {} in some, {} "
                    "in none",
                    all, whole, judged, judged - whole - none, none));
  }
  std::vector<std::string> parts;
  for (const auto& [cause, number] : causes) parts.push_back(fmt::format("{} {}", cause, number));
  if (!parts.empty()) {
    lines.push_back(fmt::format("causes of what is not: {}", fmt::join(parts, ", ")));
  }
  return lines;
}

Judged judge_cell(const CellSpec& cell, const Measured& measured, const PrintedResults& printed) {
  const std::vector<double> values = values_of(cell, measured);
  Judged judged;
  judged.values = values.size();
  judged.median = cell.is_share ? std::accumulate(values.begin(), values.end(), 0.0) /
                                      static_cast<double>(values.size())
                                : median(values);
  std::vector<double> numbers = values;
  std::erase_if(numbers, [](double value) { return std::isnan(value); });
  judged.numbers = numbers.size();
  if (!numbers.empty()) {
    const auto [smallest, largest] = std::ranges::minmax(numbers);
    judged.smallest = smallest;
    judged.largest = largest;
  }
  // A failed run counts as a run: its result is not reproduced, unless the cell has a value for
  // failures.
  std::size_t failed = 0, runs = 0;
  std::set<std::string> names;
  for (const Quantity& quantity : cell.quantities()) names.insert(quantity.run);
  for (const std::string& name : names) {
    runs += measured.at(name).size();
    failed += static_cast<std::size_t>(
        std::ranges::count(measured.at(name), PointStatus::failed, &PointResult::status));
  }
  const bool has_failed = failed > 0 && std::isnan(cell.if_failed);
  judged.measured = failed == runs              ? (runs == 1 ? "the run fails" : "the runs fail")
                    : has_failed                ? fmt::format("{} of {} runs fail", failed, runs)
                    : std::isnan(judged.median) ? "not measured"
                    : std::isinf(judged.median) ? "never"
                                                : in_digits(judged.median);
  if (!cell.shows.empty()) {
    judged.printed = cell.shows;
    judged.verdict = Verdict::shown;
    return judged;
  }
  // Whether a run without what the statement is about does as well.
  const bool is_trivial = [&] {
    if (cell.vacuous.empty() || cell.without.empty()) return !cell.vacuous.empty();
    CellSpec without = cell;
    without.quantity.run = cell.without;
    return cell.holds.contains(median(values_of(without, measured)));
  }();
  // A statement is a word that a number in its band gets.
  const bool is_statement = !cell.says.empty();
  const PrintedResult result =
      is_statement ? PrintedResult{std::nullopt, cell.says} : printed.find(cell.printed).value();
  const Standard standard =
      is_statement ? Standard{.words = {{cell.says, cell.holds}}} : printed.standard(cell.printed);
  judged.printed = result.text();
  judged.verdict = has_failed ? Verdict::not_reproduced : judge(judged.median, result, standard);
  if (is_trivial && judged.verdict <= Verdict::within_class) judged.verdict = Verdict::vacuous;
  if (is_statement) {
    judged.class_text = "holds if " + cell.holds.text();
  } else if (result.number) {
    judged.deviation = std::abs((judged.median - *result.number) / *result.number);
    judged.class_text = rule_text(standard);
  } else {
    for (const auto& [word, band] : standard.words) {
      const std::string name = PrintedResult{std::nullopt, word}.text();
      if (!judged.class_text.empty()) judged.class_text += "; ";
      judged.class_text += name + ": " + band.text();
      if (band.contains(judged.median)) judged.measured = name + " (" + judged.measured + ")";
    }
  }
  return judged;
}

CommandKind reproduce_command() {
  return {"reproduce", "run every experiment of the thesis, beside the printed results",
          [](const Catalogue& catalogue, int argc, const char* const* argv) {
            return guarded(argv[0], [&] { return reproduce_main(catalogue, argc, argv); });
          }};
}

}  // namespace breakwater
