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
#include <breakwater/pages/key_metrics.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/latex.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pages/run_report.h>
#include <breakwater/pages/signal_charts.h>
#include <breakwater/record/csv.h>
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
    const bool is_same = *value == first || (largest < kManifold && std::abs(percent) < 0.05);
    words.push_back(is_same                ? "same"
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
  for (const SavedRun& run : runs_) printed_.push_back(printed_of(catalogue, run));
  metrics_ = choose_metrics(runs_, choice.metrics);
  shots_ = shots_of(catalogue, runs_.front().scenario());
  choose_signals();
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

std::optional<double> Comparison::difference(std::size_t run, const std::string& metric) const {
  const auto first = runs_.front().metric(metric);
  const auto value = runs_[run].metric(metric);
  if (!first || !value) return std::nullopt;
  return *value - *first;
}

std::vector<std::optional<double>> Comparison::values_of(const std::string& metric) const {
  std::vector<std::optional<double>> values;
  for (const SavedRun& run : runs_) values.push_back(run.metric(metric));
  return values;
}

std::string Comparison::text(std::size_t width) const {
  std::vector<std::string> header = {"metric", "unit"};
  header.insert(header.end(), labels_.begin(), labels_.end());
  Table table(header);
  for (const Metric& metric : metrics_) {
    std::vector<std::string> values = {metric.name, metric.unit};
    std::vector<std::string> differences = {"  difference", "", ""};
    std::vector<std::string> printed = {"  printed", metric.unit};
    bool is_printed = false;
    const std::vector<std::string> words = differences_in_words(values_of(metric.name));
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const auto value = runs_[i].metric(metric.name);
      values.push_back(value ? in_digits(*value) : "-");
      const auto reference = printed_[i].find(metric.name);
      is_printed = is_printed || reference != printed_[i].end();
      printed.push_back(reference == printed_[i].end() ? "-" : reference->second.text);
      if (i == 0) continue;
      differences.push_back(words[i]);
    }
    table.add(values);
    table.add(differences);
    if (is_printed) table.add(printed);
  }
  return table.print(width);
}

std::string Comparison::json() const {
  nlohmann::ordered_json all = {{"scenario", runs_.front().scenario()},
                                {"runs", nlohmann::ordered_json::array()},
                                {"metrics", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    all["runs"].push_back({{"label", labels_[i]}, {"folder", runs_[i].folder().string()}});
  }
  const auto number = [](const std::optional<double>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
  };
  for (const Metric& metric : metrics_) {
    nlohmann::ordered_json row = {{"name", metric.name}, {"unit", metric.unit}};
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      row["values"].push_back(number(runs_[i].metric(metric.name)));
      row["differences"].push_back(number(difference(i, metric.name)));
      const auto reference = printed_[i].find(metric.name);
      row["printed"].push_back(number(
          reference == printed_[i].end() ? std::nullopt : std::optional(reference->second.number)));
    }
    all["metrics"].push_back(row);
  }
  return all.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string Comparison::csv() const {
  std::vector<std::string> header = {"metric", "unit"};
  for (const std::string& label : labels_) header.push_back(csv_text(label));
  for (std::size_t i = 1; i < runs_.size(); ++i) {
    header.push_back(csv_text(labels_[i] + " minus " + labels_[0]));
  }
  std::string text = csv_line(header);
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : "";
  };
  for (const Metric& metric : metrics_) {
    std::vector<std::string> row = {metric.name, metric.unit};
    for (const SavedRun& run : runs_) row.push_back(number(run.metric(metric.name)));
    for (std::size_t i = 1; i < runs_.size(); ++i)
      row.push_back(number(difference(i, metric.name)));
    text += csv_line(row);
  }
  return text;
}

std::string Comparison::latex() const {
  std::vector<std::vector<std::string>> rows = {{"Metric"}};
  for (const std::string& label : labels_) rows[0].push_back(latex_escaped(label));
  for (const Metric& metric : metrics_) {
    rows.push_back({latex_name(metric.name, metric.unit)});
    for (const SavedRun& run : runs_) {
      const auto value = run.metric(metric.name);
      rows.back().push_back(value ? latex_number(*value) : "--");
    }
  }
  return latex_table(rows);
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

PageData Comparison::cells_of(const std::string& metric) const {
  const std::vector<std::string> words = differences_in_words(values_of(metric));
  auto cells = PageData::array();
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    PageData cell;
    const auto value = runs_[i].metric(metric);
    cell["value"] = value ? format_number(*value) : "–";
    if (i > 0 && value && words[i] != "-") {
      cell["difference"] =
          fmt::format("{} {} {}", words[i], words[i] == "same" ? "as" : "vs", labels_.front());
    }
    const auto reference = printed_[i].find(metric);
    if (value && reference != printed_[i].end()) {
      const Agreement agreement = reference->second.agrees(*value);
      PageData printed;
      printed["number"] = reference->second.text;
      printed["verdict"] = agreement.text;
      printed["verdict_class"] = agreement.tone;
      printed["rule"] = agreement.rule;
      cell["printed"] = printed;
    }
    cells.push_back(cell);
  }
  return cells;
}

std::vector<std::string> Comparison::findings(const std::vector<ShownMetric>& keys) const {
  constexpr std::size_t kMostFindings = 2;
  std::vector<std::string> sentences, orders;
  for (const ShownMetric& key : keys) {
    std::vector<std::pair<double, std::size_t>> here, there;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (const auto value = runs_[i].metric(key.metric.name)) here.emplace_back(*value, i);
      const auto printed = printed_[i].find(key.metric.name);
      if (printed != printed_[i].end()) there.emplace_back(printed->second.number, i);
    }
    if (here.size() != runs_.size()) continue;
    std::sort(here.begin(), here.end());
    std::sort(there.begin(), there.end());
    const std::string unit = unit_after(key.metric.unit);
    if (sentences.size() < kMostFindings && here.front().first != here.back().first) {
      const auto one = [&](const auto& entry) {
        return fmt::format("{} ({}{})", labels_[entry.second], format_number(entry.first), unit);
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
        return printed_[here[place].second].at(key.metric.name).number;
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
  PageData page;
  std::optional<ReplayPart> replay;
  if (choice_.with_replay && runs_.size() <= kMostRuns) {
    std::vector<std::filesystem::path> folders;
    for (const SavedRun& run : runs_) folders.push_back(run.folder());
    replay = replay_of(catalogue_, folders, labels_, {"replay", "compare", ""}, notes);
  }
  std::optional<double> from_s = choice_.from_s;
  std::optional<double> to_s = choice_.to_s;
  if (replay && !from_s && !to_s) {
    from_s = replay->window.from_s;
    to_s = replay->window.to_s;
  }
  if (from_s || to_s) {
    Window window{from_s.value_or(0.0), to_s.value_or(0.0), 1.0};
    if (!to_s) {
      for (const SavedRun& run : runs_) {
        window.to_s = std::max(window.to_s, run.signal(signals_.front()).times_s.back());
      }
    }
    from_s = window.from_s;
    to_s = window.to_s;
    page["window"] = window_data(window, "compare");
  }
  if (replay) {
    page["replay"] = replay->box;
  }
  auto columns = PageData::array();
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    columns.push_back({{"name", labels_[i]},
                       {"colour", series_class(identities_[i])},
                       {"folder", runs_[i].folder().string()}});
  }
  auto keys = PageData::array();
  const std::vector<DifferingKey> differing = differing_keys(runs_);
  for (const DifferingKey& key : differing) {
    PageData row;
    row["key"] = key.key;
    auto values = PageData::array();
    for (const std::string& value : key.values) {
      values.push_back({{"value", value}});
    }
    row["values"] = values;
    keys.push_back(row);
  }
  page["keys"] = keys;
  page["key_count"] = std::to_string(differing.size());
  page["has_many_keys"] = differing.size() > kManyKeys;
  auto rows = PageData::array();
  auto others = PageData::array();
  std::vector<ShownMetric> key_metrics;
  for (const ShownMetric& shown :
       shown_metrics(catalogue_, runs_.front().scenario(), shots_, metrics_)) {
    if (shown.is_key) key_metrics.push_back(shown);
    PageData row;
    set_name(shown, row);
    row["cells"] = cells_of(shown.metric.name);
    (shown.is_key ? rows : others).push_back(row);
  }
  auto sentences = PageData::array();
  for (const std::string& text : findings(key_metrics))
    sentences.push_back(PageData{{"text", text}});
  page["findings"] = sentences;
  auto charts = PageData::array();
  auto other_charts = PageData::array();
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    PageChart chart = chart_of(signals_[i]);
    chart.id = fmt::format("signal-{}", i + 1);
    chart.from_s = from_s;
    chart.to_s = to_s;
    (i < keys_ ? charts : other_charts).push_back(chart.json());
  }
  auto toc = PageData::array();
  for (const auto& [href, label] :
       {std::pair("metrics", "Metrics"), std::pair("keys", "Settings that differ"),
        std::pair("signals", "Signals")}) {
    toc.push_back({{"href", href}, {"label", label}});
  }
  page["title"] = fmt::format("{} compared", fmt::join(labels_, ", "));
  page["scenario"] = runs_.front().scenario();
  page["toc"] = toc;
  page["columns"] = columns;
  page["rows"] = rows;
  page["others"] = others;
  page["charts"] = charts;
  page["other_charts"] = other_charts;
  page["other_count"] = std::to_string(signals_.size() - keys_);
  return html_page("compare", page);
}

}  // namespace breakwater
