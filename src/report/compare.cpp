#include <breakwater/report/compare.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <breakwater/report/html_page.h>
#include <breakwater/report/latex.h>
#include <breakwater/report/run_report.h>
#include <breakwater/report/thesis_report.h>
#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario/config.h>
#include <breakwater/scenario/table.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
namespace {

constexpr std::size_t kFewestRuns = 2;

// "+4.1 %", or the difference itself where a part of the first value says nothing: it is zero, of
// the other sign, or ten times smaller.
std::string relative(double difference, double of) {
  if (difference == 0.0) return "=";
  const double other = of + difference;
  const bool is_comparable = of * other > 0.0 && std::abs(other) < 10.0 * std::abs(of);
  return is_comparable ? fmt::format("{:+.1f} %", 100.0 * difference / std::abs(of))
                       : fmt::format("{:+.3g}", difference);
}

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
    if (run.failure()) {
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

std::vector<std::string> choose_signals(const std::vector<SavedRun>& runs,
                                        const std::vector<std::string>& chosen) {
  std::vector<std::string> signals;
  const auto add = [&](const std::string& name, std::size_t width) {
    const auto names = expanded(name, width);
    signals.insert(signals.end(), names.begin(), names.end());
  };
  for (const std::string& name : chosen) {
    for (const SavedRun& run : runs) run.entry(name);  // which throws if it is not there
    add(name, runs.front().entry(name).width);
  }
  if (!chosen.empty()) return signals;
  for (const LogEntry& entry : runs.front().signals()) {
    if (entry.group != "control" || entry.name == "qpos") continue;
    const bool is_common = std::all_of(runs.begin(), runs.end(), [&](const SavedRun& run) {
      return std::any_of(run.signals().begin(), run.signals().end(), [&](const LogEntry& other) {
        return other.group == entry.group && other.name == entry.name && other.width == entry.width;
      });
    });
    if (is_common) add(entry.name, entry.width);
  }
  return signals;
}

}  // namespace

Comparison::Comparison(const Catalogue& catalogue, std::vector<SavedRun> runs,
                       const std::vector<std::string>& metrics,
                       const std::vector<std::string>& signals)
    : runs_(std::move(runs)) {
  check(runs_);
  labels_ = labels_of(runs_);
  for (const SavedRun& run : runs_) printed_.push_back(printed_of(catalogue, run));
  metrics_ = choose_metrics(runs_, metrics);
  signals_ = choose_signals(runs_, signals);
}

std::optional<double> Comparison::difference(std::size_t run, const std::string& metric) const {
  const auto first = runs_.front().metric(metric);
  const auto value = runs_[run].metric(metric);
  if (!first || !value) return std::nullopt;
  return *value - *first;
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
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const auto value = runs_[i].metric(metric.name);
      values.push_back(value ? fmt::format("{:.5g}", *value) : "-");
      const auto thesis = printed_[i].find(metric.name);
      is_printed = is_printed || thesis != printed_[i].end();
      printed.push_back(thesis == printed_[i].end() ? "-" : thesis->second.result.text());
      if (i == 0) continue;
      const auto off = difference(i, metric.name);
      differences.push_back(off ? relative(*off, *runs_.front().metric(metric.name)) : "-");
    }
    table.add(values);
    table.add(differences);
    if (is_printed) table.add(printed);
  }
  return table.print(width);
}

std::string Comparison::csv() const {
  std::vector<std::string> header = {"metric", "unit"};
  header.insert(header.end(), labels_.begin(), labels_.end());
  for (std::size_t i = 1; i < runs_.size(); ++i) {
    header.push_back(labels_[i] + " minus " + labels_[0]);
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
    rows.push_back({latex_escaped(metric.name)});
    for (const SavedRun& run : runs_) {
      const auto value = run.metric(metric.name);
      rows.back().push_back(value ? latex_number(*value) : "--");
    }
  }
  return latex_table(rows);
}

std::string Comparison::html() const {
  mustache::data page;
  mustache::data columns(mustache::data::type::list);
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    mustache::data column;
    column.set("name", labels_[i]);
    column.set("folder", runs_[i].folder().string());
    columns << column;
  }
  mustache::data rows(mustache::data::type::list);
  for (const Metric& metric : metrics_) {
    mustache::data row;
    row.set("name", metric.name);
    row.set("unit", metric.unit);
    mustache::data cells(mustache::data::type::list);
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      mustache::data cell;
      const auto value = runs_[i].metric(metric.name);
      cell.set("value", value ? format_number(*value) : "–");
      const auto off = difference(i, metric.name);
      if (i > 0 && off) {
        cell.set("difference", relative(*off, *runs_.front().metric(metric.name)));
      }
      const auto thesis = printed_[i].find(metric.name);
      if (value && thesis != printed_[i].end()) {
        const Verdict verdict = thesis->second.verdict(*value);
        mustache::data printed;
        printed.set("number", thesis->second.result.text());
        printed.set("verdict", breakwater::text(verdict));
        printed.set("verdict_class", css_class(verdict));
        cell.set("printed", printed);
      }
      cells << cell;
    }
    row.set("cells", cells);
    rows << row;
  }
  mustache::data charts(mustache::data::type::list);
  for (std::size_t s = 0; s < signals_.size(); ++s) {
    const LogEntry& entry = runs_.front().entry(signals_[s]);
    PageChart chart;
    chart.id = fmt::format("signal-{}", s + 1);
    chart.group = "compare";
    chart.title = signals_[s];
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      chart.series.push_back({labels_[i], runs_.front().unit(signals_[s]), entry.description,
                              runs_[i].signal(signals_[s])});
    }
    charts << chart_data(chart);
  }
  mustache::data toc(mustache::data::type::list);
  for (const auto& [href, label] :
       {std::pair("metrics", "Metrics"), std::pair("signals", "Signals")}) {
    mustache::data entry;
    entry.set("href", href);
    entry.set("label", label);
    toc << entry;
  }
  page.set("title",
           fmt::format("{}: {} compared", runs_.front().scenario(), fmt::join(labels_, ", ")));
  page.set("scenario", runs_.front().scenario());
  page.set("first", labels_.front());
  page.set("toc", toc);
  page.set("columns", columns);
  page.set("rows", rows);
  page.set("charts", charts);
  return html_page("compare", page);
}

}  // namespace breakwater
