#include <breakwater/pages/compare.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include <breakwater/config/config.h>
#include <breakwater/experiment/differing_keys.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pages/signal_charts.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

constexpr std::size_t kFewestRuns = 2;
constexpr std::size_t kManyKeys = 4;  // a longer list is folded
constexpr std::size_t kKeySignals = 5;

void check(const std::vector<SavedRun>& runs) {
  if (runs.size() < kFewestRuns) {
    throw std::invalid_argument("compare: give two runs or more");
  }
  for (const SavedRun& run : runs) {
    if (run.scenario() != runs.front().scenario()) {
      throw std::invalid_argument(
          fmt::format("{} is a run of {}, {} of {}: compare runs of one scenario",
                      runs.front().folder().string(), runs.front().scenario(),
                      run.folder().string(), run.scenario()));
    }
    if (run.failure() && !run.failure()->is_cut) {
      throw std::invalid_argument(fmt::format(
          "{}: the run failed at {:.6g} s and has no metrics: leave it out, or look at it "
          "with {} report",
          run.folder().string(), run.failure()->time_s, own_program_name()));
    }
  }
}

// In the order of the first run that has them.
std::vector<Metric> choose_metrics(const std::vector<SavedRun>& runs,
                                   const std::vector<std::string>& chosen) {
  std::vector<Metric> all;
  for (const SavedRun& run : runs) {
    for (const Metric& metric : run.metrics()) {
      const bool is_known = std::any_of(all.begin(), all.end(),
                                        [&](const Metric& m) { return m.name == metric.name; });
      if (!is_known) all.push_back(metric);
    }
  }
  if (chosen.empty()) return all;
  std::vector<Metric> metrics;
  for (const std::string& name : chosen) {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Metric& m) { return m.name == name; });
    if (found == all.end()) {
      std::vector<std::string> names;
      for (const Metric& metric : all) names.push_back(metric.name);
      throw std::invalid_argument("--metric " + name + ": no run has it" +
                                  did_you_mean(name, names));
    }
    metrics.push_back(*found);
  }
  return metrics;
}

// A signal's name, or those of all its values.
std::vector<std::string> expanded(const std::string& name, std::size_t width) {
  if (width == 1 || name.find('[') != std::string::npos) return {name};
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= width; ++i) names.push_back(fmt::format("{}[{}]", name, i));
  return names;
}

// The run that says what a signal is: the first that has it.
const SavedRun* first_with(const std::vector<SavedRun>& runs, const std::string& signal) {
  const auto found = std::find_if(runs.begin(), runs.end(),
                                  [&](const SavedRun& run) { return run.has_signal(signal); });
  return found == runs.end() ? nullptr : &*found;
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
  identities_ = identities_of(catalogue, runs_);
  shots_ = shots_of(catalogue, runs_.front());
  const std::vector<Metric> metrics = choose_metrics(runs_, choice.metrics);
  shown_ = shown_metrics(catalogue, runs_.front().scenario(), shots_, metrics);
  std::vector<std::map<std::string, ReferenceValue>> printed;
  for (const SavedRun& run : runs_) printed.push_back(printed_of(catalogue, run));
  for (const Metric& metric : metrics) {
    const auto shown = std::find_if(shown_.begin(), shown_.end(), [&](const ShownMetric& one) {
      return one.metric.name == metric.name;
    });
    rows_[metric.name] = row_of(*shown, printed);
  }
  choose_signals();
}

// The metric's name, and a cell for each run.
PageData Comparison::row_of(
    const ShownMetric& shown,
    const std::vector<std::map<std::string, ReferenceValue>>& printed) const {
  const Metric& metric = shown.metric;
  PageData row = PageData::array({{{"value", metric_label_with_unit(metric.name, metric.unit)},
                                   {"unit", metric.unit},
                                   {"tip", shown.about}}});
  std::vector<std::optional<double>> values;
  for (const SavedRun& run : runs_) values.push_back(run.metric(metric.name));
  const std::vector<std::string> words = differences_in_words(values);
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    PageData cell = {{"value", nullptr}, {"difference", nullptr}, {"printed", nullptr}};
    cell["in_words"] = words[i];
    auto lines = PageData::array();
    if (values[i]) cell["value"] = *values[i];
    if (values[i] && values[0]) {
      cell["difference"] = *values[i] - *values[0];
      if (i > 0) {
        lines.push_back({{"text", fmt::format("{} {} {}", words[i],
                                              words[i] == "same" ? "as" : "vs", labels_.front())},
                         {"kind", "spread"}});
      }
    }
    const auto reference = printed[i].find(metric.name);
    if (reference != printed[i].end()) {
      cell["printed"] = reference->second.number;
      cell["printed_text"] = reference->second.text;
      if (values[i]) {
        for (const PageData& line : printed_lines(reference->second, *values[i])) {
          lines.push_back(line);
        }
      }
    }
    cell["lines"] = lines;
    row.push_back(cell);
  }
  return row;
}

// The chosen signals, or the signals that all runs have, the most important first.
void Comparison::choose_signals() {
  for (const std::string& name : choice_.signals) {
    const SavedRun* run = first_with(runs_, name);
    const LogEntry& entry = run != nullptr ? run->entry(name) : runs_.front().entry(name);
    const auto names = expanded(name, entry.width);
    signals_.insert(signals_.end(), names.begin(), names.end());
  }
  keys_ = signals_.size();
  if (!choice_.signals.empty()) return;
  // The first of each of the page's charts is what runs are compared by.
  for (const ShotPage::KeyChart& chart : shots_.page.charts) {
    const auto place =
        std::find_if(chart.signals.begin(), chart.signals.end(),
                     [&](const std::string& name) { return is_common(name) && changes(name); });
    if (place == chart.signals.end()) continue;
    const auto names = expanded(*place, runs_.front().entry(*place).width);
    signals_.insert(signals_.end(), names.begin(), names.end());
  }
  const std::vector<LoggedQuantity> logged = quantities(runs_.front().signals(), shots_);
  // Without such a list they are compared by the first quantities that differ.
  if (shots_.page.charts.empty()) {
    for (const LoggedQuantity& quantity : logged) {
      if (signals_.size() >= kKeySignals) break;
      const LogEntry& entry = quantity.kinds.front();
      const std::string path = signal_path(entry);
      if (entry.width == 1 && is_common(path) && differs(path)) signals_.push_back(path);
    }
  }
  keys_ = signals_.size();
  for (const LoggedQuantity& quantity : logged) {
    for (const LogEntry& entry : quantity.kinds) {
      if (!is_common(signal_path(entry))) continue;
      for (const std::string& name : expanded(signal_path(entry), entry.width)) {
        const bool is_there = std::find(signals_.begin(), signals_.end(), name) != signals_.end();
        if (!is_there && changes(name)) signals_.push_back(name);
      }
    }
  }
}

bool Comparison::is_common(const std::string& signal) const {
  return std::all_of(runs_.begin(), runs_.end(), [&](const SavedRun& run) {
    return run.has_signal(signal) && run.entry(signal).width == runs_.front().entry(signal).width;
  });
}

bool Comparison::changes(const std::string& signal) const {
  if (runs_.front().entry(signal).width > 1 && signal.find('[') == std::string::npos) return true;
  const double first = runs_.front().signal(signal).values.front();
  return std::any_of(runs_.begin(), runs_.end(), [&](const SavedRun& run) {
    const std::vector<double> values = run.signal(signal).values;
    return std::any_of(values.begin(), values.end(), [&](double v) { return v != first; });
  });
}

bool Comparison::differs(const std::string& signal) const {
  const std::vector<double> first = runs_.front().signal(signal).values;
  return std::any_of(runs_.begin() + 1, runs_.end(),
                     [&](const SavedRun& run) { return run.signal(signal).values != first; });
}

std::string Comparison::text(std::size_t width) const {
  std::vector<std::string> header = {"metric", "unit"};
  header.insert(header.end(), labels_.begin(), labels_.end());
  Table table(header);
  for (const auto& [name, row] : rows_.items()) {
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
    table.add(values);
    table.add(differences);
    if (is_printed) table.add(printed);
  }
  return table.print(width);
}

std::string Comparison::json() const {
  PageData all = {{"scenario", runs_.front().scenario()},
                  {"runs", PageData::array()},
                  {"metrics", PageData::array()}};
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    all["runs"].push_back({{"label", labels_[i]}, {"folder", runs_[i].folder().string()}});
  }
  for (const auto& [name, row] : rows_.items()) {
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
  std::vector<std::string> header = {"metric", "unit"};
  for (const std::string& label : labels_) header.push_back(csv_text(label));
  for (std::size_t i = 1; i < runs_.size(); ++i) {
    header.push_back(csv_text(labels_[i] + " minus " + labels_[0]));
  }
  std::string text = csv_line(header);
  for (const auto& [name, row] : rows_.items()) {
    std::vector<std::string> line = {name, row[0]["unit"].get<std::string>()};
    const auto add = [&](std::size_t from, const char* what) {
      for (std::size_t i = from; i < row.size(); ++i) {
        const PageData& number = row[i][what];
        line.push_back(number.is_null() ? "" : fmt::format("{}", number.get<double>()));
      }
    };
    add(1, "value");
    add(2, "difference");
    text += csv_line(line);
  }
  return text;
}

PageChart Comparison::chart_of(const std::string& signal) const {
  const SavedRun& one = *first_with(runs_, signal);
  PageChart chart;
  chart.group = "compare";
  const LogEntry& entry = one.entry(signal);
  const std::string label = signal_label(entry), quantity = quantity_of(entry);
  const std::size_t open = signal.find('[');
  chart.title =
      capitalised(quantity.empty() || quantity == label ? label : quantity + ", " + label) +
      (open == std::string::npos ? "" : " " + signal.substr(open));
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    ChartSeries series;
    series.label = labels_[i];
    series.unit = one.unit(signal);
    series.description = signal + ": " + entry.description;
    series.identity = identities_[i];
    if (runs_[i].has_signal(signal)) {
      series.values = runs_[i].signal(signal);
    } else {
      series.label += ": –";
      series.description = "this run's log does not have it";
    }
    chart.series.push_back(series);
  }
  return chart;
}

std::vector<std::string> Comparison::findings() const {
  constexpr std::size_t kMostFindings = 2;
  std::vector<std::string> sentences, orders;
  for (const ShownMetric& key : shown_) {
    if (!key.is_key) continue;
    const PageData& row = rows_[key.metric.name];
    std::vector<std::pair<double, std::size_t>> here, there;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const PageData &value = row[i + 1]["value"], &printed = row[i + 1]["printed"];
      if (!value.is_null()) here.emplace_back(value.get<double>(), i);
      if (!printed.is_null()) there.emplace_back(printed.get<double>(), i);
    }
    if (here.size() != runs_.size()) continue;
    std::sort(here.begin(), here.end());
    std::sort(there.begin(), there.end());
    const std::string unit = unit_after(key.metric.unit);
    if (sentences.size() < kMostFindings && here.front().first != here.back().first) {
      const auto one = [&](const auto& entry) {
        return fmt::format("{} ({}{})", labels_[entry.second], in_digits(entry.first), unit);
      };
      sentences.push_back(fmt::format("{} is smallest for {} and largest for {}.", key.label,
                                      one(here.front()), one(here.back())));
    }
    const auto order = [&](const auto& entries) {
      std::vector<std::string> names;
      for (const auto& entry : entries) names.push_back(labels_[entry.second]);
      return fmt::format("{}", fmt::join(names, ", "));
    };
    // A printed value that is less than that of the run before it. Equal ones have no order.
    bool is_other_order = false;
    for (std::size_t i = 1; i < here.size() && there.size() == here.size(); ++i) {
      const auto printed = [&](std::size_t place) {
        return row[here[place].second + 1]["printed"].get<double>();
      };
      is_other_order |= here[i - 1].first < here[i].first && printed(i - 1) > printed(i);
    }
    if (is_other_order) {
      orders.push_back(fmt::format(
          "{}: the order differs from the thesis. From the smallest: here {}; in the thesis {}.",
          key.label, order(here), order(there)));
    }
  }
  std::vector<std::string> all;
  if (!sentences.empty()) all.push_back(fmt::format("{}", fmt::join(sentences, " ")));
  all.insert(all.end(), orders.begin(), orders.end());
  return all;
}

std::string Comparison::html(std::vector<std::string>& notes) const {
  std::optional<ReplayPart> replay;
  if (choice_.with_replay && runs_.size() <= kMostRuns) {
    std::vector<std::filesystem::path> folders;
    for (const SavedRun& run : runs_) folders.push_back(run.folder());
    replay = replay_of(catalogue_, folders, labels_, {"replay", "compare", ""}, notes);
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
  PageData columns = {"metric"}, key_columns = {"key"};
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    columns.push_back({{"value", labels_[i]},
                       {"look", series_class(identities_[i])},
                       {"tip", runs_[i].folder().string()}});
    key_columns.push_back({{"value", labels_[i]}, {"tip", runs_[i].folder().string()}});
  }
  auto rows = PageData::array(), other_rows = PageData::array();
  for (const ShownMetric& shown : shown_) {
    (shown.is_key ? rows : other_rows).push_back(rows_[shown.metric.name]);
  }
  const auto table = [](const char* label, const PageData& heads, const PageData& cells) {
    return PageData{
        {"label", label}, {"kind", "numbers measured"}, {"columns", heads}, {"rows", cells}};
  };
  const auto folded = [](const std::string& summary, bool is_open, const char* kind,
                         const PageData& value) {
    auto blocks = PageData::array();
    add_block(blocks, kind, value);
    return PageData{{"summary", summary}, {"is_open", is_open}, {"blocks", blocks}};
  };
  auto lead = PageData::array(), metrics = PageData::array(), keys = PageData::array(),
       signals = PageData::array(), sections = PageData::array();
  add_block(lead, "about", fmt::format("Runs of {}.", runs_.front().scenario()));
  for (const std::string& text : findings()) add_block(lead, "finding", text);
  add_block(metrics, "table", table("Metrics", columns, rows));
  if (!other_rows.empty()) {
    add_block(
        metrics, "fold",
        folded("All metrics", false, "table", table("All other metrics", columns, other_rows)));
  }
  auto key_rows = PageData::array();
  for (const DifferingKey& key : differing_keys(runs_)) {
    key_rows.push_back({key.key});
    for (const std::string& value : key.values) key_rows.back().push_back(value);
  }
  if (key_rows.empty()) {
    add_block(keys, "text", "The runs have the same settings.");
  } else {
    PageData differing = table("Settings that differ", key_columns, key_rows);
    differing["kind"] = "numbers keys-table";
    add_block(keys, "fold",
              folded(fmt::format("Settings that differ: {}", key_rows.size()),
                     key_rows.size() <= kManyKeys, "table", differing));
  }
  if (replay) add_block(keys, "replay", replay->box);
  auto figures = PageData::array(), other_figures = PageData::array();
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    PageChart chart = chart_of(signals_[i]);
    chart.id = fmt::format("signal-{}", i + 1);
    if (window) {
      chart.from_s = window->from_s;
      chart.to_s = window->to_s;
    }
    (i < keys_ ? figures : other_figures).push_back(figure_of(chart));
  }
  add_block(signals, "text",
            "Drag to zoom in all charts at once, double-click to see all again; keys + − 0 and the "
            "arrows do the same. A signal's button switches it off and on. t = 0 is the start of "
            "each run.");
  if (window) signals.back()["window"] = window_data(*window, "compare");
  add_block(signals, "figures", figures);
  if (!other_figures.empty()) {
    add_block(signals, "fold",
              folded(fmt::format("All signals: {} more charts", other_figures.size()), false,
                     "figures", other_figures));
  }
  sections.push_back({{"id", "metrics"}, {"blocks", metrics}});
  sections.push_back({{"id", "keys"}, {"blocks", keys}});
  sections.push_back({{"id", "signals"}, {"heading", "Signals"}, {"blocks", signals}});
  auto toc = PageData::array();
  for (const auto& [href, label] :
       {std::pair("metrics", "Metrics"), std::pair("keys", "Settings that differ"),
        std::pair("signals", "Signals")}) {
    toc.push_back({{"href", href}, {"label", label}});
  }
  return html_page("compare", {{"title", fmt::format("{} compared", fmt::join(labels_, ", "))},
                               {"lead", lead},
                               {"sections", sections},
                               {"toc", toc}});
}

}  // namespace breakwater
