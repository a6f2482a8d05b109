#include <breakwater/thesis/thesis_report.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/input_file.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/thesis/reproduction.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// Reads the logs of one section at a time, each log once.
class Logs {
 public:
  explicit Logs(fs::path out) : out_(std::move(out)) {}

  const SavedRun& of(const std::string& run) {
    const auto found = runs_.find(run);
    if (found != runs_.end()) return found->second;
    return runs_.emplace(run, SavedRun(run_folder(out_, run))).first->second;
  }

 private:
  fs::path out_;
  std::map<std::string, SavedRun> runs_;
};

// `label` is the run's.
ChartSeries series_of(const SavedRun& run, const std::string& signal, const std::string& label,
                      const PanelSpec& panel) {
  const bool is_one_of_many = panel.signals.size() > 1;
  const LogEntry& entry = run.entry(signal);
  const double least = std::numeric_limits<double>::lowest();
  const double most = std::numeric_limits<double>::max();
  const std::string unit = run.unit(signal);
  const std::size_t open = signal.find('[');
  const std::string name =
      metric_label(entry.name, unit) + (open == std::string::npos ? "" : " " + signal.substr(open));
  return {label.empty() ? name : label + (is_one_of_many ? ", " + name : ""), unit,
          signal + ": " + entry.description,
          cut(run.signal(signal), panel.from_s.value_or(least), panel.to_s.value_or(most))};
}

std::vector<PageChart> charts_of(const FigureSpec& figure, const std::string& group, Logs& logs) {
  std::vector<PageChart> charts;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const PanelSpec& panel = figure.panels[i];
    PageChart chart;
    chart.id = fmt::format("figure-{}-{}", anchor(figure.number), i + 1);
    // A panel with its own time window has its own time axis.
    chart.group = group;
    if (panel.from_s || panel.to_s) {
      chart.axis = fmt::format("{}-from-{:g}-to-{:g}", group, panel.from_s.value_or(0.0),
                               panel.to_s.value_or(0.0));
    }
    chart.title = panel.title;
    chart.lines = panel.lines;
    for (const std::string& signal : panel.once) {
      chart.series.push_back(series_of(logs.of(figure.runs.front().run), signal, "", panel));
      chart.series.back().identity = role_of_signal(signal).value_or(kReferenceIdentity);
    }
    for (const FigureRun& run : figure.runs) {
      for (const std::string& signal : panel.signals) {
        chart.series.push_back(series_of(logs.of(run.run), signal, run.label, panel));
        // If a figure has several runs, each has its own colour.
        if (figure.runs.size() == 1) chart.series.back().identity = role_of_signal(signal);
        chart.series.back().is_off =
            std::find(figure.off.begin(), figure.off.end(), run.label) != figure.off.end();
      }
    }
    charts.push_back(chart);
  }
  return charts;
}

// How far a measured number is from the printed one, relative to it; infinite without a number.
double deviation(const Judged& judged, const PrintedResult& printed) {
  const double off = std::abs((judged.median - *printed.number) / *printed.number);
  return std::isfinite(off) ? off : std::numeric_limits<double>::infinity();
}

// A judged cell and its place.
struct Entry {
  const SectionSpec& section;
  const TableSpec& table;
  std::size_t row, column;
  const CellSpec& cell;
  Judged judged;

  bool is_counted() const { return cell.shows.empty() && cell.reading.empty(); }
  bool is_failure() const { return is_counted() && judged.verdict == Verdict::not_reproduced; }
  std::string what() const {
    return table.rows[row] + (table.columns.size() > 1 ? ", " + table.columns[column] : "");
  }
};

std::vector<Entry> entries_of(const Reproduction& reproduction, const Measured& measured) {
  std::vector<Entry> all;
  for (const SectionSpec* section : reproduction.sections) {
    for (const TableSpec& table : section->tables) {
      for (std::size_t r = 0; r < table.rows.size(); ++r) {
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
          const auto& cell = table.cells[r][c];
          if (!cell) continue;
          all.push_back(
              {*section, table, r, c, *cell, judge_cell(*cell, measured, printed_results())});
        }
      }
    }
  }
  return all;
}

void count(const Entry& entry, bool is_own, Score& score) {
  if (!entry.is_counted()) return;
  const auto& [section, table, row, column, cell, judged] = entry;
  const auto printed = printed_results().find(cell.printed);
  if (printed && printed->number) {
    const double off = deviation(judged, *printed);
    ++score.numbers;
    score.numbers_near += off <= 0.05 ? 1 : 0;
    score.numbers_off += off > 0.25 ? 1 : 0;
  }
  Score::Share& share = printed ? score.printed : score.statements[section.id + ": " + cell.says];
  ++share.all;
  if (judged.is_vacuous) {
    ++share.vacuous;
    ++score.vacuous;
    return;
  }
  const bool is_own_statement = is_own && !cell.says.empty();
  switch (judged.verdict) {
    case Verdict::reproduced:
      ++share.reproduced;
      ++(is_own_statement ? score.holds : score.reproduced);
      break;
    case Verdict::within_class:
      ++share.within_class;
      ++score.within_class;
      break;
    case Verdict::not_reproduced:
      ++score.causes[cell.cause];
      ++(is_own_statement ? score.does_not_hold : score.not_reproduced);
      break;
    case Verdict::not_measured:
      ++score.not_measured;
      break;
  }
}

PageData tallies_data(const Score& score) {
  auto list = PageData::array();
  for (const Score::Tally& tally : score.tallies()) {
    list.push_back(
        {{"kind", css_class(tally.verdict)}, {"count", tally.count}, {"word", tally.word}});
  }
  return list;
}

// The reason for a missing number.
std::string missing_text(const CellSpec& cell, std::size_t missing, std::size_t values) {
  std::string what = cell.quantity.metric;
  if (cell.over && cell.over->metric != what) {
    what += " or " + cell.over->metric;
  } else if (cell.over) {
    what += " of one or the other";
  }
  return values == 1 ? "no " + what : fmt::format("no {} in {} of {} runs", what, missing, values);
}

// How the values of several runs differ.
std::string spread_text(const CellSpec& cell, const Judged& judged) {
  const std::size_t missing = judged.values - judged.numbers;
  if (missing > 0) {
    return judged.verdict == Verdict::not_measured ? missing_text(cell, missing, judged.values)
                                                   : "";
  }
  if (judged.values < 2) return "";
  return judged.smallest < judged.largest
             ? fmt::format("{} to {} in {} runs", in_digits(judged.smallest),
                           in_digits(judged.largest), judged.values)
             : fmt::format("the same in {} runs", judged.values);
}

// The place of a text in a list, counted from one; a new one goes to its end.
std::size_t number_in(std::vector<std::string>& list, const std::string& text) {
  auto place = std::find(list.begin(), list.end(), text);
  if (place == list.end()) place = list.insert(list.end(), text);
  return static_cast<std::size_t>(place - list.begin()) + 1;
}

void add_table(const TableSpec& table, const std::vector<Entry>& entries, bool is_own,
               PageData& blocks) {
  std::vector<std::string> notes, classes;
  PageData columns = PageData::array({table.unit.empty() ? "" : "[" + table.unit + "]"});
  for (const std::string& column : table.columns) columns.push_back(column);
  auto rows = PageData::array();
  for (const std::string& row : table.rows) {
    rows.push_back(PageData::array({row}));
    for (std::size_t c = 0; c < table.columns.size(); ++c) rows.back().push_back("");
  }
  for (const Entry& entry : entries) {
    if (&entry.table != &table) continue;
    const auto& [section, of, r, c, cell, judged] = entry;
    auto lines = PageData::array();
    const auto add = [&](const std::string& kind, const std::string& text) {
      if (!text.empty()) lines.push_back({{"text", text}, {"kind", kind}});
    };
    const bool is_judged = cell.shows.empty();
    if (!cell.printed.empty()) add("printed", "thesis " + judged.printed);
    add("spread", spread_text(cell, judged));
    if (is_judged) {
      if (!cell.says.empty()) {
        add("printed", judged.class_text);
      } else {
        number_in(classes, judged.class_text);
      }
      add("verdict " + css_class(judged.is_vacuous ? Verdict::not_measured : judged.verdict),
          verdict_word(judged, cell, is_own));
      lines.back()["tip"] = judged.class_text;
    } else {
      add("printed", "beside the rest, not judged");
    }
    const std::string why = reason_of(judged, cell);
    if (!why.empty()) add("note", std::to_string(number_in(notes, why)));
    rows[r][c + 1] = {
        {"says", cell.says + cell.shows}, {"value", judged.measured}, {"lines", lines}};
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

// The command for a run, with its log in a folder of the run's name.
std::string command_of(const RunSpec& run) {
  std::string command =
      fmt::format("{} run {} --case {}", own_program_name(), run.scenario, run.case_name);
  std::vector<std::string> sets = run.sets;
  const std::vector<std::string>& more = run.repetitions.front();
  sets.insert(sets.end(), more.begin(), more.end());
  if (!sets.empty()) command += " --set";
  for (const std::string& set : sets) command += " " + shell_word(set);
  return command + " --out " + run.name;
}

PageData figure_data(const FigureSpec& figure, const SectionSpec& section,
                     const Experiments& experiments, Logs& logs) {
  auto charts = PageData::array();
  for (const PageChart& chart : charts_of(figure, "section-" + anchor(section.id), logs)) {
    charts.push_back(chart.json());
  }
  std::string commands;
  for (const FigureRun& run : figure.runs) {
    commands += command_of(experiments.runs.at(run.run)) + "\n";
    if (const auto& failure = logs.of(run.run).failure()) {
      commands +=
          fmt::format("{} fails at {:.4g} s: {}\n", run.run, failure->time_s, failure->reason);
    }
  }
  auto blocks = PageData::array();
  add_block(blocks, "code", {{"summary", "Command"}, {"text", commands}});
  return {{"id", "figure-" + anchor(figure.number)},
          {"number", figure.number},
          {"caption", figure.title},
          {"charts", charts},
          {"note", figure.note},
          {"blocks", blocks}};
}

// The charts at the top of the page.
PageData hero_figures(const Reproduction& reproduction, Logs& logs) {
  auto figures = PageData::array();
  for (const HeroSpec& hero : reproduction.experiments.heroes) {
    for (const SectionSpec* section : reproduction.sections) {
      for (const FigureSpec& figure : section->figures) {
        if (figure.number != hero.figure) continue;
        PageChart chart = charts_of(figure, "lead-" + anchor(figure.number), logs).at(hero.panel);
        chart.id = "lead-" + chart.id;
        figures.push_back(figure_of(chart));
        figures.back().update({{"caption", hero.caption},
                               {"link", "Fig. " + hero.figure.substr(0, hero.figure.find(' '))},
                               {"href", "figure-" + anchor(hero.figure)}});
      }
    }
  }
  return figures;
}

// The results that are not reproduced, by cause.
PageData causes_section(const std::vector<Entry>& entries) {
  std::map<std::string, PageData> lists;
  for (const Entry& entry : entries) {
    const Judged& judged = entry.judged;
    if (!entry.is_failure()) continue;
    lists[entry.cell.cause].push_back(
        {{"href", "section-" + anchor(entry.section.id)},
         {"link", entry.section.id},
         {"text", fmt::format("{}: {}, thesis: {}. {}", entry.what(), judged.measured,
                              judged.printed, reason_of(judged, entry.cell))}});
  }
  if (lists.empty()) return {};
  auto blocks = PageData::array();
  add_block(blocks, "text",
            "thesis: the text contradicts itself or its numbers. hardware: it is about the "
            "laboratory's arm or cart. ours: a reading, a metric or a limit of this project is in "
            "doubt.");
  for (const auto& [cause, list] : lists) {
    add_block(blocks, "subheading",
              fmt::format("{}: {}", cause.empty() ? "not said" : cause, list.size()));
    blocks.push_back({{"list", list}, {"kind", "missing"}});
  }
  return {{"id", "causes"}, {"heading", "Not reproduced, by cause"}, {"blocks", blocks}};
}

std::string verdict_list(const std::vector<Entry>& entries, bool is_own) {
  const auto exact = [](double value) { return std::isnan(value) ? "" : fmt::format("{}", value); };
  std::string text = csv_line({"section",  "table",    "row",         "column",  "run",
                               "metric",   "over_run", "over_metric", "divisor", "statistic",
                               "measured", "smallest", "largest",     "runs",    "printed",
                               "says",     "holds_if", "verdict",     "cause",   "why"});
  for (const Entry& entry : entries) {
    const auto& [section, table, row, column, cell, judged] = entry;
    const Quantity over = cell.over.value_or(Quantity{});
    const bool has_numbers = judged.numbers > 0;
    text += csv_line({section.id,
                      table.title,
                      table.rows[row],
                      table.columns[column],
                      cell.quantity.run,
                      cell.quantity.metric,
                      over.run,
                      over.metric,
                      exact(cell.divisor),
                      cell.is_share ? "share" : "median",
                      exact(judged.median),
                      has_numbers ? exact(judged.smallest) : "",
                      has_numbers ? exact(judged.largest) : "",
                      std::to_string(judged.values),
                      cell.printed.empty() ? "" : judged.printed,
                      cell.says + cell.shows,
                      judged.class_text,
                      verdict_word(judged, cell, is_own),
                      judged.verdict == Verdict::not_reproduced ? cell.cause : "",
                      reason_of(judged, cell)});
  }
  return text;
}

std::string failure_list(const std::vector<Entry>& entries, bool is_own) {
  constexpr std::size_t kFew = 15;
  std::vector<std::string> failures, counts;
  std::vector<std::pair<std::string, std::size_t>> by_section;
  for (const Entry& entry : entries) {
    if (!entry.is_failure()) continue;
    const std::string& id = entry.section.id;
    if (by_section.empty() || by_section.back().first != id) by_section.emplace_back(id, 0);
    ++by_section.back().second;
    failures.push_back(fmt::format("  {}, {}: {}, {} ({})\n", id, entry.what(),
                                   entry.judged.measured, entry.judged.printed,
                                   entry.judged.class_text));
  }
  if (failures.empty()) return "";
  const std::string verdict = is_own ? "did not hold" : "not reproduced";
  if (failures.size() <= kFew) return fmt::format("{}:\n{}", verdict, fmt::join(failures, ""));
  for (const auto& [section, number] : by_section) {
    counts.push_back(fmt::format("{}: {}", section, number));
  }
  return fmt::format("{}, by section: {}\n", verdict, fmt::join(counts, ", "));
}

}  // namespace

std::string verdict_word(const Judged& judged, const CellSpec& cell, bool is_own) {
  if (!cell.shows.empty()) return "shown";
  if (judged.is_vacuous) return "vacuous";
  const std::string before = cell.reading.empty() ? "" : "other reading: ";
  // A statement of a user's own list holds; it is not reproduced.
  const bool is_own_statement = is_own && !cell.says.empty();
  if (!is_own_statement || judged.verdict == Verdict::not_measured) {
    return before + text(judged.verdict);
  }
  return before + (judged.verdict == Verdict::reproduced ? "holds" : "does not hold");
}

std::string reason_of(const Judged& judged, const CellSpec& cell) {
  if (!cell.reading.empty()) return cell.reading;
  if (judged.is_vacuous) return cell.vacuous;
  if (!cell.shows.empty() || judged.verdict == Verdict::reproduced) return "";
  return cell.why;
}

std::vector<Score::Tally> Score::tallies() const {
  std::vector<Tally> all;
  const bool has_own = holds + does_not_hold > 0;
  if (reproduced + within_class + not_reproduced > 0 || !has_own) {
    all.push_back({reproduced, "reproduced", Verdict::reproduced});
    all.push_back({within_class, "within the class", Verdict::within_class});
    all.push_back({not_reproduced, "not reproduced", Verdict::not_reproduced});
  }
  if (has_own) {
    all.push_back({holds, "held", Verdict::reproduced});
    all.push_back({does_not_hold, "did not hold", Verdict::not_reproduced});
  }
  if (not_measured > 0) all.push_back({not_measured, "not measured", Verdict::not_measured});
  return all;
}

std::string Score::text() const {
  std::vector<std::string> parts;
  for (const Tally& tally : tallies())
    parts.push_back(fmt::format("{} {}", tally.count, tally.word));
  return fmt::format("{}{}", fmt::join(parts, ", "),
                     vacuous > 0 ? fmt::format("; beside them {} vacuous", vacuous) : "");
}

std::vector<std::string> Score::headline() const {
  std::vector<std::string> lines;
  if (printed.all > 0) {
    lines.push_back(fmt::format(
        "printed results: {} of {} reproduced, {} within their class, {} not, {} vacuous",
        printed.reproduced, printed.all, printed.within_class,
        printed.all - printed.reproduced - printed.within_class - printed.vacuous,
        printed.vacuous));
  }
  if (numbers > 0) {
    lines.push_back(fmt::format("printed numbers: {} of {} within 5 %, {} within 25 %",
                                numbers_near, numbers, numbers - numbers_off));
  }
  int whole = 0;
  int none = 0;
  int judged = 0;
  int cells = 0;
  for (const auto& [statement, share] : statements) {
    const int counted = share.all - share.vacuous;
    if (counted == 0) continue;
    whole += share.reproduced == counted ? 1 : 0;
    none += share.reproduced == 0 ? 1 : 0;
    cells += counted;
    ++judged;
  }
  if (judged > 0) {
    lines.push_back(
        fmt::format("different statements ({} cells): {} of {} hold in all cells, {} in some, {} "
                    "in none",
                    cells, whole, judged, judged - whole - none, none));
  }
  std::vector<std::string> parts;
  for (const auto& [cause, number] : causes) {
    parts.push_back(fmt::format("{} {}", cause.empty() ? "not said" : cause, number));
  }
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
  std::vector<double> numbers;
  std::copy_if(values.begin(), values.end(), std::back_inserter(numbers),
               [](double value) { return !std::isnan(value); });
  judged.numbers = numbers.size();
  if (!numbers.empty()) {
    judged.smallest = *std::min_element(numbers.begin(), numbers.end());
    judged.largest = *std::max_element(numbers.begin(), numbers.end());
  }
  // A failed run counts as a run: its result is not reproduced, unless the cell has a value for
  // failures.
  std::size_t failed = 0;
  std::size_t runs = 0;
  std::set<std::string> names;
  for (const Quantity& quantity : cell.quantities()) names.insert(quantity.run);
  for (const std::string& name : names) {
    for (const Measurement& one : measured.at(name)) {
      failed += one.failed ? 1 : 0;
      ++runs;
    }
  }
  const bool has_failed = failed > 0 && std::isnan(cell.if_failed);
  if (failed == runs) {
    judged.measured = runs == 1 ? "the run fails" : "the runs fail";
  } else if (has_failed) {
    judged.measured = fmt::format("{} of {} runs fail", failed, runs);
  } else {
    judged.measured = std::isnan(judged.median)   ? "not measured"
                      : std::isinf(judged.median) ? "never"
                                                  : in_digits(judged.median);
  }
  const auto final_verdict = [&](Verdict verdict) {
    return has_failed ? Verdict::not_reproduced : verdict;
  };
  if (!cell.shows.empty()) {
    judged.printed = cell.shows;
    return judged;
  }
  // Whether a run without what the statement is about does as well.
  const bool is_trivial = [&] {
    if (cell.vacuous.empty() || cell.without.empty()) return !cell.vacuous.empty();
    CellSpec without = cell;
    without.quantity.run = cell.without;
    return cell.holds.contains(median(values_of(without, measured)));
  }();
  if (!cell.says.empty()) {
    judged.printed = cell.says;
    judged.class_text = "holds if " + cell.holds.text();
    const bool holds = cell.holds.contains(judged.median);
    judged.verdict = final_verdict(std::isnan(judged.median) ? Verdict::not_measured
                                   : holds                   ? Verdict::reproduced
                                                             : Verdict::not_reproduced);
    judged.is_vacuous = is_trivial && judged.verdict == Verdict::reproduced;
    return judged;
  }
  const PrintedResult result = printed.find(cell.printed).value();
  const Standard& standard = printed.standard(cell.printed);
  judged.printed = result.text();
  judged.verdict = final_verdict(judge(judged.median, result, standard));
  judged.is_vacuous = is_trivial && judged.verdict != Verdict::not_reproduced &&
                      judged.verdict != Verdict::not_measured;
  if (result.number) {
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

ThesisReport thesis_report(const Reproduction& reproduction, const Measured& measured,
                           Effort effort) {
  const Experiments& experiments = reproduction.experiments;
  const bool is_own = experiments.is_own;
  const std::vector<Entry> entries = entries_of(reproduction, measured);
  ThesisReport report;
  std::set<std::string> docs;
  std::set<std::string> numbers;  // "4.32 (10 ms)" is a part of Fig. 4.32
  auto toc = PageData::array(), sections = PageData::array(), lead_video = PageData::array();
  for (const SectionSpec* spec : reproduction.sections) {
    const std::string id = "section-" + anchor(spec->id);
    Logs logs(reproduction.out);
    auto blocks = PageData::array();
    add_block(blocks, "paragraph", spec->text);
    if (!spec->docs.empty()) {
      docs.insert(spec->docs);
      blocks.back().update({{"link", "docs/" + spec->docs}, {"href", anchor(spec->docs)}});
    }
    add_block(blocks, "text", "This section alone: breakwater reproduce --only " + spec->id);
    for (const TableSpec& table : spec->tables) add_table(table, entries, is_own, blocks);
    if (!spec->video.empty() && reproduction.with_replay) {
      const SavedRun& shown = logs.of(spec->video);
      const auto replay = replay_of(reproduction.catalogue, {shown.folder()}, {spec->video},
                                    {"replay-" + anchor(spec->id), id, ""}, report.notes);
      if (replay) add_block(blocks, "replay", replay->box);
    }
    if (!spec->video.empty()) {
      if (auto video = video_data(reproduction.catalogue, logs.of(spec->video), id)) {
        if (spec->id == experiments.video) {
          add_block(lead_video, "video", *video);
          // It moves with the first picture beside it.
          lead_video[0]["video"]["group"] =
              experiments.heroes.empty() ? "lead"
                                         : "lead-" + anchor(experiments.heroes.front().figure);
          video->erase("address");  // it is the same
        }
        add_block(blocks, "video", *video);
      }
    }
    const fs::path strip = run_folder(reproduction.out, spec->strip) / "strip.png";
    if (!spec->strip.empty() && fs::exists(strip)) {
      add_block(blocks, "picture",
                {{"address", data_address(strip, "image/png")},
                 {"number", spec->strip_number},
                 {"caption", "Moments of the experiment."},
                 {"id", "figure-" + anchor(spec->strip_number)},
                 {"alt", "Pictures of the run " + spec->strip + " in a row"}});
      numbers.insert(spec->strip_number);
    }
    auto figures = PageData::array();
    for (const FigureSpec& figure : spec->figures) {
      figures.push_back(figure_data(figure, *spec, experiments, logs));
      numbers.insert(figure.number.substr(0, figure.number.find(' ')));
    }
    add_block(blocks, "figures", figures);
    if (!spec->missing.empty()) {
      auto missing = PageData::array();
      for (const auto& [what, why] : spec->missing) {
        missing.push_back({{"what", what}, {"text", why}});
      }
      add_block(blocks, "subheading", "Not shown");
      blocks.push_back({{"list", missing}, {"kind", "missing"}});
    }
    sections.push_back(
        {{"id", id}, {"number", spec->id}, {"heading", spec->title}, {"blocks", blocks}});
    toc.push_back({{"href", id}, {"number", spec->id}, {"label", spec->title}});
    Score score;
    for (const Entry& entry : entries) {
      if (&entry.section != spec) continue;
      count(entry, is_own, score);
      count(entry, is_own, report.score);
    }
    if (!spec->tables.empty()) {
      toc.back()["score"] = {{"words", score.text()}, {"tallies", tallies_data(score)}};
    }
  }
  report.figures = numbers.size();
  report.verdicts = verdict_list(entries, is_own);
  report.failures = failure_list(entries, is_own);
  if (PageData causes = is_own ? PageData() : causes_section(entries); !causes.is_null()) {
    sections.push_back(std::move(causes));
  }
  auto pages = PageData::array();
  add_block(pages, "text", "As they stood when this report was made.");
  for (const std::string& name : docs) {
    add_block(pages, "code",
              {{"id", anchor(name)},
               {"summary", "docs/" + name},
               {"copy", bytes_of(data_file("docs/" + name))}});
  }
  sections.push_back(
      {{"id", "pages"}, {"heading", "Pages of the documentation"}, {"blocks", pages}});

  std::string extent =
      effort == Effort::quick
          ? "This is the quick version: fewer seeds and encoder phases than the full one."
          : "This is the full version, with all seeds and encoder phases.";
  if (reproduction.sections.size() < experiments.sections.size()) {
    extent += " Only the sections in the contents were asked for.";
  }
  for (const ReadingSpec& reading : experiments.readings) {
    if (!reading.is_chosen) continue;
    extent += fmt::format(" Other reading {}: {} with {}. {}", reading.name, reading.runs,
                          fmt::join(reading.sets, " "), reading.why);
  }
  int all = 0;
  for (const Score::Tally& tally : report.score.tallies()) all += tally.count;
  auto lead = PageData::array(), headline = PageData::array();
  add_block(lead, "about",
            is_own ? extent
                   : "Every experiment of the thesis “Robust Model-based Control in Motion Control "
                     "Systems”, run in MuJoCo. Each printed number, verdict and figure stands "
                     "beside the one measured here. " +
                         extent);
  if (!is_own) {
    for (const std::string& line : report.score.headline()) {
      headline.push_back(PageData{{"text", line}});
    }
  }
  add_block(lead, "list", headline);
  add_block(lead, "score", tallies_data(report.score));
  if (report.score.vacuous > 0) {
    add_block(lead, "text",
              fmt::format("Beside these, and not counted among them: {} vacuous, which hold by "
                          "construction. Other readings than a section's stand in its tables; "
                          "their notes say which, and no count has them.",
                          report.score.vacuous));
  }
  add_block(
      lead, "text",
      is_own
          ? fmt::format(
                "{} results. A statement holds or does not, as its list says. \"Reproduced\" is "
                "said of numbers that the thesis prints, by the classes of data/reproduced.toml. "
                "The criterion stands below each table, and at each verdict. A result that is not "
                "measured counts as neither. A random result is the median of its runs.",
                all)
          : fmt::format(
                "{} printed numbers, verdicts and statements. data/reproduced.toml has the "
                "criterion of each. docs/how-to/reproducing-the-thesis.md says which were chosen "
                "with the results known. They stand below each table, and at each verdict. A "
                "random result is the median of its runs. {} figures carry the thesis' numbers.",
                all, report.figures));
  lead.insert(lead.end(), lead_video.begin(), lead_video.end());
  Logs logs(reproduction.out);
  add_block(lead, "figures", hero_figures(reproduction, logs));
  const std::string title = experiments.title.empty() ? "Experiments" : experiments.title;
  report.html = html_page("thesis", {{"title", is_own ? title : "The thesis, reproduced"},
                                     {"lead", lead},
                                     {"sections", sections},
                                     {"toc", toc}});
  return report;
}

namespace fs = std::filesystem;
namespace {

// Whether a reading changes a run of the section.
bool changes(const Experiments& experiments, const std::string& name, const SectionSpec& section) {
  const std::vector<std::string> runs = section.runs();
  return std::any_of(experiments.readings.begin(), experiments.readings.end(),
                     [&](const ReadingSpec& reading) {
                       return reading.name == name &&
                              std::any_of(runs.begin(), runs.end(), [&](const std::string& run) {
                                return matches_pattern(reading.runs, run);
                              });
                     });
}

std::vector<std::string> sections_of(const Experiments& experiments, const std::string& name) {
  std::vector<std::string> sections;
  for (const SectionSpec& section : experiments.sections) {
    if (changes(experiments, name, section)) sections.push_back(section.id);
  }
  return sections;
}

constexpr std::size_t kWidth = 78;  // for an indented text

struct ReproduceArguments {
  std::string only = "all";
  std::string out = "runs/reproduce";
  std::string file;
  std::vector<std::string> readings;
  bool list_readings = false;
  bool quick = false;
  bool no_video = false;
  bool with_replay = true;
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

// The readings, with the sections whose runs they change. The first row of one has its reason.
void print_readings(const Experiments& experiments) {
  std::set<std::string> known;
  for (const ReadingSpec& reading : experiments.readings) {
    if (known.insert(reading.name).second) {
      fmt::print("{} (sections {})\n", reading.name,
                 fmt::join(sections_of(experiments, reading.name), ", "));
      for (const std::string& line : wrapped(reading.why, kWidth)) fmt::print("  {}\n", line);
    }
    fmt::print("  {}: {}\n", reading.runs, fmt::join(reading.sets, " "));
  }
}

// A reading that changes no run of the chosen sections is a mistake.
void check_readings(const ReproduceArguments& arguments, const Experiments& experiments,
                    const std::vector<const SectionSpec*>& chosen) {
  for (const std::string& name : arguments.readings) {
    const bool is_heeded = std::any_of(
        chosen.begin(), chosen.end(),
        [&](const SectionSpec* section) { return changes(experiments, name, *section); });
    if (is_heeded) continue;
    throw std::invalid_argument(
        fmt::format("--reading {}: changes no run of --only {}, but runs of the sections {}", name,
                    arguments.only, fmt::join(sections_of(experiments, name), ", ")));
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

// Makes pictures and videos that are missing or older than the run. Returns the status of the last
// failure.
int make_pictures(const Reproduction& reproduction, bool with_video) {
  int status = kSuccess;
  const auto make = [&](const std::string& run, const char* command, const char* file,
                        std::vector<std::string> options) {
    const fs::path folder = run_folder(reproduction.out, run);
    if (run.empty() || fs::exists(folder / file)) return;
    std::vector<std::string> words = {own_program(), command, folder.string(), "--quiet"};
    words.insert(words.end(), options.begin(), options.end());
    if (!reproduction.quiet) fmt::print(stderr, "reproduce: {} of {}\n", command, run);
    const int made = call_program(command, words);
    if (made != kSuccess) status = made == kInterrupted ? kInterrupted : kLaterOutputFailed;
  };
  for (const SectionSpec* section : reproduction.sections) {
    if (status == kInterrupted) break;
    if (with_video) make(section->video, "video", "video.mp4", {"--size", "800x450"});
    make(section->strip, "strip", "strip.png", {"--size", "420x240"});
  }
  return status;
}

int reproduce(const Catalogue& catalogue, const ReproduceArguments& arguments) {
  const fs::path file =
      arguments.file.empty() ? data_file("data/experiments.toml") : fs::path(arguments.file);
  const Effort effort = arguments.quick ? Effort::quick : Effort::full;
  const Experiments experiments = read_experiments(file.string(), effort, arguments.readings);
  if (arguments.list_readings) {
    print_readings(experiments);
    return kSuccess;
  }
  const std::vector<const SectionSpec*> sections = choose_sections(experiments, arguments.only);
  check_readings(arguments, experiments, sections);
  check_out(arguments.out);
  stop_on_signals();
  const Reproduction reproduction{
      catalogue,      experiments,          sections, arguments.out, arguments.quiet,
      &interrupted(), arguments.with_replay};
  const Measured measured = measure(reproduction);
  const int status = make_pictures(reproduction, !arguments.no_video);
  if (status == kInterrupted) throw Interrupted(measured.size());
  const ThesisReport report = thesis_report(reproduction, measured, effort);
  for (const std::string& note : report.notes) fmt::print(stderr, "reproduce: {}\n", note);
  const fs::path page = reproduction.out / "report.html";
  replace_file(page, report.html);
  const fs::path verdicts = reproduction.out / "verdicts.csv";
  replace_file(verdicts, report.verdicts);
  if (!experiments.is_own) {
    for (const std::string& line : report.score.headline()) fmt::print("{}\n", line);
  }
  if (!arguments.readings.empty()) {
    fmt::print("other readings: {}; a reason is that of the shipped one unless it names another\n",
               fmt::join(arguments.readings, ", "));
  }
  fmt::print("{}", report.failures);
  fmt::print("{}\n{} figures\nreport: {}\nverdicts: {}\n", report.score.text(), report.figures,
             page.string(), verdicts.string());
  return status;
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
  app.add_flag("--list-readings", arguments.list_readings, "print the readings, and end");
  app.add_flag("--no-video", arguments.no_video, "leave out the video");
  app.add_flag("!--no-replay", arguments.with_replay, "leave out the replays");
  app.add_flag("--quiet", arguments.quiet, "print errors and the score only");
  app.footer(
      "Results of the same configuration, models and program are kept, so an interrupted\n"
      "reproduction continues. data/reproduced.toml has the criteria.\n"
      "Exit status: 0 success, 1 a defect, 2 usage or input, 4 a picture or video could not be\n"
      "made, 130 interrupted.");
  if (const auto status = parse(app, argc, argv)) return *status;
  return reproduce(catalogue, arguments);
}

}  // namespace

CommandKind reproduce_command() {
  return {"reproduce", "run every experiment of the thesis, beside the printed results",
          [](const Catalogue& catalogue, int argc, const char* const* argv) {
            return guarded(argv[0], [&] { return reproduce_main(catalogue, argc, argv); });
          }};
}

}  // namespace breakwater
