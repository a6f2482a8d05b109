#include <breakwater/thesis/thesis_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/decimation.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/file_bytes.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/paths.h>

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

void count(const Judged& judged, const CellSpec& cell, const std::string& section, bool is_own,
           Score& score) {
  if (!cell.reading.empty()) return;
  const auto printed = printed_results().find(cell.printed);
  if (printed && printed->number) {
    const double off = deviation(judged, *printed);
    ++score.numbers;
    score.numbers_near += off <= 0.05 ? 1 : 0;
    score.numbers_off += off > 0.25 ? 1 : 0;
  }
  const auto one_if = [&](Verdict verdict) {
    return judged.verdict == verdict && !judged.is_vacuous ? 1 : 0;
  };
  (printed ? score.printed : score.statements[section + ": " + cell.says]) +=
      {one_if(Verdict::reproduced), one_if(Verdict::within_class), judged.is_vacuous ? 1 : 0, 1};
  if (judged.is_vacuous) {
    ++score.vacuous;
    return;
  }
  if (judged.verdict == Verdict::not_reproduced) ++score.causes[cell.cause];
  const bool is_own_statement = is_own && !cell.says.empty();
  switch (judged.verdict) {
    case Verdict::reproduced:
      ++(is_own_statement ? score.holds : score.reproduced);
      break;
    case Verdict::within_class:
      ++score.within_class;
      break;
    case Verdict::not_reproduced:
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

PageData table_data(const TableSpec& table, const std::string& section, const Measured& measured,
                    bool is_own, Score& score, std::map<std::string, PageData>& failures) {
  const PrintedResults& printed = printed_results();
  PageData data;
  data["table_title"] = table.title;
  if (!table.unit.empty()) data["unit"] = table.unit;
  if (!table.note.empty()) data["table_note"] = table.note;
  auto columns = PageData::array();
  for (const std::string& column : table.columns) {
    columns.push_back({{"name", column}});
  }
  data["columns"] = columns;

  std::vector<std::string> notes;
  std::vector<std::string> classes;
  auto rows = PageData::array();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    PageData row;
    row["name"] = table.rows[r];
    auto cells = PageData::array();
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const auto& spec = table.cells[r][c];
      PageData cell;
      if (spec) {
        const Judged judged = judge_cell(*spec, measured, printed);
        const bool is_judged = spec->shows.empty();
        if (is_judged) count(judged, *spec, section, is_own, score);
        PageData filled;
        filled["measured"] = judged.measured;
        const std::size_t missing = judged.values - judged.numbers;
        if (missing > 0 && judged.verdict == Verdict::not_measured) {
          filled["spread"] = missing_text(*spec, missing, judged.values);
        } else if (judged.values > 1 && missing == 0) {
          filled["spread"] =
              judged.smallest < judged.largest
                  ? fmt::format("{} to {} in {} runs", format_number(judged.smallest),
                                format_number(judged.largest), judged.values)
                  : fmt::format("the same in {} runs", judged.values);
        }
        if (!spec->printed.empty()) filled["printed"] = judged.printed;
        if (!spec->says.empty()) filled["says"] = judged.printed;
        if (is_judged) {
          filled["verdict"] = {
              {"word", verdict_word(judged, *spec, is_own)},
              {"kind", css_class(judged.is_vacuous ? Verdict::not_measured : judged.verdict)},
              {"class_text", judged.class_text}};
          if (!spec->says.empty()) {
            filled["limit"] = judged.class_text;
          } else if (std::find(classes.begin(), classes.end(), judged.class_text) ==
                     classes.end()) {
            classes.push_back(judged.class_text);
          }
        } else {
          filled["shows"] = judged.printed;
        }
        const std::string why = reason_of(judged, *spec);
        if (is_judged && spec->reading.empty() && judged.verdict == Verdict::not_reproduced) {
          failures[spec->cause].push_back(
              {{"section", section},
               {"section_anchor", "section-" + anchor(section)},
               {"what", table.rows[r] + (table.columns.size() == 1 ? "" : ", " + table.columns[c])},
               {"says", judged.printed},
               {"measured", judged.measured},
               {"why", why}});
        }
        if (!why.empty()) {
          auto place = std::find(notes.begin(), notes.end(), why);
          if (place == notes.end()) place = notes.insert(notes.end(), why);
          filled["note"] = std::to_string(place - notes.begin() + 1);
        }
        cell["filled"] = filled;
      }
      cells.push_back(cell);
    }
    row["cells"] = cells;
    rows.push_back(row);
  }
  data["rows"] = rows;
  if (!classes.empty()) data["classes"] = fmt::format("{}", fmt::join(classes, " · "));
  if (!notes.empty()) {
    auto list = PageData::array();
    for (std::size_t i = 0; i < notes.size(); ++i) {
      list.push_back({{"number", i + 1}, {"why", notes[i]}});
    }
    data["notes"] = list;
  }
  return data;
}

PageData figure_data(const FigureSpec& figure, const SectionSpec& section,
                     const Experiments& experiments, Logs& logs) {
  PageData data;
  data["number"] = figure.number;
  data["anchor"] = "figure-" + anchor(figure.number);
  data["figure_title"] = figure.title;
  if (!figure.note.empty()) data["note"] = figure.note;
  auto charts = PageData::array();
  for (const PageChart& chart : charts_of(figure, "section-" + anchor(section.id), logs)) {
    charts.push_back(chart.json());
  }
  data["charts"] = charts;
  auto commands = PageData::array();
  for (const FigureRun& run : figure.runs) {
    PageData command;
    command["command"] = command_of(experiments.runs.at(run.run));
    const auto& failure = logs.of(run.run).failure();
    if (failure) {
      command["failure"] =
          fmt::format("{} fails at {:.4g} s: {}", run.run, failure->time_s, failure->reason);
    }
    commands.push_back(command);
  }
  data["commands"] = commands;
  return data;
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

Score::Share& Score::Share::operator+=(const Share& other) {
  reproduced += other.reproduced;
  within_class += other.within_class;
  vacuous += other.vacuous;
  all += other.all;
  return *this;
}

Score& Score::operator+=(const Score& other) {
  reproduced += other.reproduced;
  within_class += other.within_class;
  not_reproduced += other.not_reproduced;
  not_measured += other.not_measured;
  holds += other.holds;
  does_not_hold += other.does_not_hold;
  vacuous += other.vacuous;
  printed += other.printed;
  for (const auto& [statement, share] : other.statements) statements[statement] += share;
  numbers += other.numbers;
  numbers_near += other.numbers_near;
  numbers_off += other.numbers_off;
  for (const auto& [cause, number] : other.causes) causes[cause] += number;
  return *this;
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
    judged.measured = format_number(judged.median);
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

std::string command_of(const RunSpec& run, std::size_t repetition) {
  std::string command =
      fmt::format("{} run {} --case {}", own_program_name(), run.scenario, run.case_name);
  std::vector<std::string> sets = run.sets;
  const std::vector<std::string>& more = run.repetitions.at(repetition);
  sets.insert(sets.end(), more.begin(), more.end());
  if (!sets.empty()) command += " --set";
  for (const std::string& set : sets) command += " " + shell_word(set);
  return command + " --out " + run.name;
}

ThesisReport thesis_report(const Reproduction& reproduction, const Measured& measured,
                           Effort effort) {
  const Experiments& experiments = reproduction.experiments;
  ThesisReport report;
  std::map<std::string, PageChart> hero_charts;  // by figure and panel
  std::map<std::string, PageData> failures;      // by cause
  std::set<std::string> docs;
  std::set<std::string> numbers;  // "4.32 (10 ms)" is a part of Fig. 4.32
  auto toc = PageData::array();
  auto sections = PageData::array();
  PageData page;
  for (const SectionSpec* spec : reproduction.sections) {
    const std::string id = "section-" + anchor(spec->id);
    Logs logs(reproduction.out);
    Score score;
    PageData section;
    section["anchor"] = id;
    section["id"] = spec->id;
    section["section_title"] = spec->title;
    section["text"] = spec->text;
    if (!spec->docs.empty()) {
      section["docs"] = spec->docs;
      section["docs_anchor"] = anchor(spec->docs);
      docs.insert(spec->docs);
    }
    auto tables = PageData::array();
    for (const TableSpec& table : spec->tables) {
      tables.push_back(table_data(table, spec->id, measured, experiments.is_own, score, failures));
    }
    section["tables"] = tables;
    if (!spec->video.empty() && reproduction.with_replay) {
      const SavedRun& shown = logs.of(spec->video);
      const auto replay = replay_of(reproduction.catalogue, {shown.folder()}, {spec->video},
                                    {"replay-" + anchor(spec->id), id, ""}, report.notes);
      if (replay) {
        section["replay"] = replay->box;
      }
    }
    if (!spec->video.empty()) {
      if (auto video = video_data(reproduction.catalogue, logs.of(spec->video), id)) {
        if (spec->id == experiments.video) {
          (*video)["address"] = PageData();  // already shown above
        }
        section["video"] = *video;
      }
    }
    const fs::path strip = run_folder(reproduction.out, spec->strip) / "strip.png";
    if (!spec->strip.empty() && fs::exists(strip)) {
      PageData picture;
      picture["address"] = data_address(strip, "image/png");
      picture["number"] = spec->strip_number;
      picture["anchor"] = "figure-" + anchor(spec->strip_number);
      picture["alt"] = "Pictures of the run " + spec->strip + " in a row";
      section["strip"] = picture;
      numbers.insert(spec->strip_number);
      if (spec->id == experiments.video) page["lead_strip"] = picture;
    }
    auto figures = PageData::array();
    for (const FigureSpec& figure : spec->figures) {
      figures.push_back(figure_data(figure, *spec, experiments, logs));
      numbers.insert(figure.number.substr(0, figure.number.find(' ')));
      for (const HeroSpec& hero : experiments.heroes) {
        if (hero.figure != figure.number) continue;
        hero_charts[hero.figure] =
            charts_of(figure, "lead-" + anchor(figure.number), logs).at(hero.panel);
      }
    }
    section["figures"] = figures;
    auto missing = PageData::array();
    for (const MissingSpec& what : spec->missing) {
      missing.push_back({{"what", what.what}, {"why", what.why}});
    }
    if (!spec->missing.empty()) {
      section["missing"] = missing;
    }
    sections.push_back(section);

    PageData entry;
    entry["href"] = id;
    entry["number"] = spec->id;
    entry["label"] = spec->title;
    if (!spec->tables.empty()) {
      entry["score"] = {{"words", score.text()}, {"tallies", tallies_data(score)}};
    }
    toc.push_back(entry);
    report.score += score;
  }

  report.figures = numbers.size();
  auto heroes = PageData::array();
  for (const HeroSpec& hero : experiments.heroes) {
    const auto found = hero_charts.find(hero.figure);
    if (found == hero_charts.end()) continue;
    PageChart chart = found->second;
    chart.id = "lead-" + chart.id;
    PageData entry = chart.json();
    entry["caption"] = hero.caption;
    entry["number"] = hero.figure.substr(0, hero.figure.find(' '));
    entry["href"] = "figure-" + anchor(hero.figure);
    heroes.push_back(entry);
  }
  auto pages = PageData::array();
  for (const std::string& name : docs) {
    pages.push_back({{"name", "docs/" + name},
                     {"anchor", anchor(name)},
                     {"text", bytes_of(data_file("docs/" + name))}});
  }

  const std::string title = experiments.title.empty() ? "Experiments" : experiments.title;
  page["title"] = experiments.is_own ? title : "Breakwater: the thesis, reproduced";
  page["is_own"] = experiments.is_own;
  page["toc"] = toc;
  page["sections"] = sections;
  page["heroes"] = heroes;
  page["pages"] = pages;
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
  page["extent"] = extent;
  int all = 0;
  for (const Score::Tally& tally : report.score.tallies()) all += tally.count;
  page["tallies"] = tallies_data(report.score);
  page["all"] = all;
  if (report.score.vacuous > 0) page["vacuous"] = report.score.vacuous;
  auto headline = PageData::array();
  const bool has_causes = !experiments.is_own && !failures.empty();
  for (const std::string& line :
       experiments.is_own ? std::vector<std::string>{} : report.score.headline())
    headline.push_back(PageData{{"line", line}});
  page["headline"] = headline;
  auto causes = PageData::array();
  for (const auto& [cause, list] : failures) {
    causes.push_back({{"failures", list},
                      {"cause", cause.empty() ? "not said" : cause},
                      {"count", report.score.causes[cause]}});
  }
  page["causes"] = causes;
  page["has_causes"] = has_causes;
  page["figure_count"] = report.figures;
  for (const SectionSpec* spec : reproduction.sections) {
    if (spec->id != experiments.video || spec->video.empty()) continue;
    Logs logs(reproduction.out);
    // It moves with the first picture beside it.
    const std::string group =
        experiments.heroes.empty() ? "lead" : "lead-" + anchor(experiments.heroes.front().figure);
    const auto video = video_data(reproduction.catalogue, logs.of(spec->video), group);
    if (video) page["lead_video"] = *video;
  }
  report.html = html_page("thesis", page);
  return report;
}

}  // namespace breakwater
