#include <breakwater/pages/compare.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include <breakwater/config/config.h>
#include <breakwater/experiment/differing_keys.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pages/run_report.h>
#include <breakwater/pages/signal_charts.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

constexpr std::size_t kFewestRuns = 2;
constexpr std::size_t kManyKeys = 4;  // a longer list is folded

void check(const std::vector<SavedRun>& runs) {
  if (runs.size() < kFewestRuns) {
    throw std::invalid_argument("compare: give two runs or more");
  }
  const SavedRun& first = runs.front();
  for (const SavedRun& run : runs) {
    if (run.scenario() != first.scenario()) {
      throw std::invalid_argument(fmt::format(
          "{} is a run of {}, {} of {}: compare runs of one scenario", first.folder().string(),
          first.scenario(), run.folder().string(), run.scenario()));
    }
    if (!run.failure() || run.failure()->is_cut) continue;
    throw std::invalid_argument(fmt::format(
        "{}: the run failed at {:.6g} s and has no metrics: leave it out, or look at it with {} "
        "report",
        run.folder().string(), run.failure()->time_s, own_program_name()));
  }
}

// The chosen metrics, or all, in the order of the first run that has them.
std::vector<Metric> choose_metrics(const std::vector<SavedRun>& runs,
                                   const std::vector<std::string>& chosen) {
  std::vector<Metric> all;
  std::vector<std::string> names;
  for (const SavedRun& run : runs) {
    for (const Metric& metric : run.metrics()) {
      if (metric_in(all, metric.name)) continue;
      all.push_back(metric);
      names.push_back(metric.name);
    }
  }
  for (const std::string& name : chosen) {
    if (metric_in(all, name)) continue;
    throw std::invalid_argument(
        fmt::format("--metric: {}: no run has it{}", name, did_you_mean(name, names)));
  }
  return chosen.empty() ? all : main_metrics(chosen, all);
}

// The run that says what a signal is: the first that has it.
const SavedRun& first_with(const std::vector<SavedRun>& runs, const std::string& signal) {
  const auto found =
      std::ranges::find_if(runs, [&](const SavedRun& run) { return run.has_signal(signal); });
  return found == runs.end() ? runs.front() : *found;
}

}  // namespace

std::vector<std::string> differences_in_words(const std::vector<std::optional<double>>& values) {
  constexpr double kManifold = 3.0, kNoMeasure = 10.0;
  double largest = 0.0;  // largest ratio; infinite if it says nothing
  for (const std::optional<double>& value : values) {
    if (!value || !values.front() || *value == *values.front()) continue;
    const double ratio = *value / *values.front();
    largest = std::max(largest, ratio > 0.0 ? ratio : std::numeric_limits<double>::infinity());
  }
  std::vector<std::string> words;
  for (const std::optional<double>& value : values) {
    if (!value || !values.front()) {
      words.emplace_back("-");
      continue;
    }
    const double first = *values.front();
    const double percent = 100.0 * (*value - first) / std::abs(first);
    words.push_back(*value == first        ? "same"
                    : largest < kManifold  ? fmt::format("{:+.1f} %", percent)
                    : largest < kNoMeasure ? fmt::format("×{:.2f}", *value / first)
                                           : fmt::format("{:+.3g}", *value - first));
  }
  return words;
}

Comparison::Comparison(const Catalogue& catalogue, std::vector<SavedRun> runs,
                       const CompareChoice& choice)
    : catalogue_(catalogue), choice_(choice), runs_(std::move(runs)) {
  check(runs_);
  if (choice.from_s && choice.to_s && !(*choice.from_s < *choice.to_s)) {
    throw std::invalid_argument(
        fmt::format("--from {:g}, --to {:g}: must rise", *choice.from_s, *choice.to_s));
  }
  labels_ = labels_of(catalogue, runs_);
  styles_ = styles_of(catalogue, runs_);
  shots_ = shots_of(catalogue, runs_.front());
  const std::vector<Metric> metrics = choose_metrics(runs_, choice.metrics);
  rows_ = metric_rows(catalogue, runs_, shots_, metrics, labels_.front());
  for (const Metric& metric : metrics) {
    if (std::ranges::find(names_, metric.name) == names_.end()) names_.push_back(metric.name);
  }
  choose_signals();
}

// The chosen signals, or those of the first run's page that all runs have: the first of each of its
// key charts, then the others.
void Comparison::choose_signals() {
  const SavedRun& front = runs_.front();
  const auto add = [&](const std::string& signal) {
    if (std::ranges::find(signals_, signal) == signals_.end()) signals_.push_back(signal);
  };
  for (const std::string& name : choice_.signals) {
    for (const std::string& value : value_names(first_with(runs_, name), name)) add(value);
  }
  keys_ = signals_.size();
  if (keys_ > 0) return;
  const auto is_common = [&](const ChartSeries& one) {
    return std::ranges::all_of(runs_, [&](const SavedRun& run) {
      return run.has_signal(one.signal) &&
             run.entry(one.signal).width == front.entry(one.signal).width;
    });
  };
  const SignalCharts charts = signal_charts(front, "", shots_);
  for (const PageChart& chart : charts.key) {
    const auto first = std::ranges::find_if(chart.series, is_common);
    if (first != chart.series.end()) add(first->signal);
  }
  keys_ = signals_.size();
  for (const auto* some : {&charts.key, &charts.others}) {
    for (const PageChart& chart : *some) {
      for (const ChartSeries& one : chart.series) {
        if (is_common(one)) add(one.signal);
      }
    }
  }
}

std::string Comparison::text(std::size_t width) const {
  std::vector<std::string> header = {"metric", "unit"};
  header.insert(header.end(), labels_.begin(), labels_.end());
  TextRows rows = {header};
  for (const std::string& name : names_) {
    const PageData& row = rows_[name];
    const std::string unit = row[0]["unit"];
    std::vector<std::string> values = {name, unit}, differences = {"  difference", "", ""},
                             printed = {"  printed", unit};
    bool is_printed = false;
    for (std::size_t i = 1; i < row.size(); ++i) {
      values.push_back(text_of(row[i]));
      if (i > 1) differences.push_back(text_of(row[i]["in_words"]));
      is_printed |= row[i].contains("printed_text");
      printed.push_back(row[i].value("printed_text", "-"));
    }
    rows.push_back(values);
    rows.push_back(differences);
    if (is_printed) rows.push_back(printed);
  }
  return in_columns(std::move(rows), width);
}

std::string Comparison::json() const {
  PageData all = {{"scenario", runs_.front().scenario()},
                  {"runs", PageData::array()},
                  {"metrics", PageData::array()}};
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    all["runs"].push_back({{"label", labels_[i]}, {"folder", runs_[i].folder().string()}});
  }
  for (const std::string& name : names_) {
    const PageData& row = rows_[name];
    PageData metric = {{"name", name}, {"unit", row[0]["unit"]}};
    for (std::size_t i = 1; i < row.size(); ++i) {
      metric["values"].push_back(row[i]["value"]);
      metric["differences"].push_back(row[i]["difference"]);
      metric["printed"].push_back(row[i]["printed"]);
    }
    all["metrics"].push_back(metric);
  }
  return all.dump(2, ' ', false, PageData::error_handler_t::replace) + "\n";
}

std::string Comparison::csv() const {
  std::vector<std::string> columns = {"metric", "unit"};
  for (const std::string& label : labels_) columns.push_back(csv_text(label));
  for (std::size_t i = 1; i < runs_.size(); ++i) {
    columns.push_back(csv_text(labels_[i] + " minus " + labels_[0]));
  }
  std::string text = csv_line(columns);
  for (const std::string& name : names_) {
    const PageData& row = rows_[name];
    std::vector<std::string> line = {name, row[0]["unit"]};
    for (const auto& [from, what] : {std::pair(1, "value"), std::pair(2, "difference")}) {
      for (auto cell = row.begin() + from; cell != row.end(); ++cell) {
        const PageData& number = (*cell)[what];
        line.push_back(number.is_null() ? "" : fmt::format("{}", number.get<double>()));
      }
    }
    text += csv_line(line);
  }
  return text;
}

PageChart Comparison::chart_of(const std::string& signal) const {
  PageChart chart;
  chart.group = "compare";
  chart.title = signal;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    ChartSeries series{.label = labels_[i] + ": –",
                       .unit = first_with(runs_, signal).unit(signal),
                       .description = "this run's log does not have it"};
    if (runs_[i].has_signal(signal)) series = series_of(runs_[i], signal, labels_[i]);
    series.style = styles_[i];
    chart.series.push_back(series);
  }
  return chart;
}

std::string Comparison::html(std::vector<std::string>& notes) const {
  std::optional<ReplayPart> replay;
  if (choice_.with_replay && runs_.size() <= kMostRuns) {
    replay = replay_of(catalogue_, runs_, "compare", notes);
  }
  std::optional<Window> window;
  if (choice_.from_s || choice_.to_s) {
    window = Window{choice_.from_s.value_or(0.0), choice_.to_s.value_or(0.0), 1.0};
    for (const SavedRun& run : runs_) {
      if (choice_.to_s) break;
      window->to_s = std::max(window->to_s, run.signal(signals_.front()).times_s.back());
    }
  } else if (replay) {
    window = replay->window;
  }
  PageData columns = {"metric"};
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    columns.push_back({{"value", labels_[i]},
                       {"look", series_class(styles_[i])},
                       {"tip", runs_[i].folder().string()}});
  }
  auto rows = PageData::array(), other_rows = PageData::array();
  for (const PageData& row : rows_) (row[0]["is_key"] == true ? rows : other_rows).push_back(row);
  // A table, and one that is folded away.
  const auto add_table = [&columns](PageData& blocks, const char* label, const char* kind,
                                    const PageData& cells) {
    add_block(blocks, "table",
              {{"label", label}, {"kind", kind}, {"columns", columns}, {"rows", cells}});
  };
  const auto add_fold = [&add_table](PageData& blocks, const std::string& summary, bool is_open,
                                     const char* label, const char* kind, const PageData& cells) {
    auto folded = PageData::array();
    add_table(folded, label, kind, cells);
    add_block(blocks, "fold", {{"summary", summary}, {"is_open", is_open}, {"blocks", folded}});
  };
  auto lead = PageData::array(), metrics = PageData::array(), keys = PageData::array(),
       signals = PageData::array();
  add_block(lead, "about", fmt::format("Runs of {}.", runs_.front().scenario()));
  add_table(metrics, "Metrics", "numbers measured", rows);
  if (!other_rows.empty()) {
    add_fold(metrics, "All metrics", false, "All other metrics", "numbers measured", other_rows);
  }
  auto key_rows = PageData::array();
  for (const DifferingKey& key : differing_keys(runs_)) {
    key_rows.push_back({key.key});
    for (const std::string& value : key.values) key_rows.back().push_back(value);
  }
  if (key_rows.empty()) {
    add_block(keys, "text", "The runs have the same settings.");
  } else {
    columns[0] = "key";
    add_fold(keys, number_of(key_rows.size(), "setting"), key_rows.size() <= kManyKeys,
             "Settings that differ", "numbers keys-table", key_rows);
  }
  if (replay) add_block(keys, "replay", replay->box);
  std::vector<PageChart> charts, other_charts;
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    PageChart& chart = (i < keys_ ? charts : other_charts).emplace_back(chart_of(signals_[i]));
    chart.id = fmt::format("signal-{}", i + 1);
  }
  add_block(signals, "text",
            "Drag to zoom in all charts at once, double-click to see all again; keys + − 0 and the "
            "arrows do the same. A signal's button switches it off and on. t = 0 is the start of "
            "each run.");
  if (window) signals.back()["window"] = window_data(*window, "compare");
  add_block(signals, "figures", figures_of(charts, window));
  if (!other_charts.empty()) add_other_charts(signals, "all", other_charts, window);
  auto sections = PageData::array();
  add_section(sections, "metrics", "Metrics", metrics);
  add_section(sections, "keys", "Settings that differ", keys);
  add_section(sections, "signals", "Signals", signals);
  return html_page("compare", {{"title", fmt::format("{} compared", fmt::join(labels_, ", "))},
                               {"lead", lead},
                               {"sections", sections}});
}

}  // namespace breakwater
