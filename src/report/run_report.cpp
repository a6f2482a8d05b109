#include <breakwater/report/run_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>

#include <breakwater/report/html_page.h>
#include <breakwater/report/thesis_report.h>
#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario/runner.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace mustache = kainjow::mustache;
namespace {

// "q_rad" of "q_true_rad" and "q_hat_rad": what they are all about.
std::string stem(const std::string& name) {
  static constexpr std::array<const char*, 4> kKinds = {"_true", "_measured", "_hat", "_ref"};
  for (const char* kind : kKinds) {
    const std::size_t at = name.find(std::string(kind) + "_");
    if (at != std::string::npos) {
      return name.substr(0, at) + name.substr(at + std::string(kind).size());
    }
  }
  return name;
}

mustache::data metrics_data(const Catalogue& catalogue, const SavedRun& run) {
  const std::map<std::string, PrintedValue> printed = printed_of(catalogue, run);
  mustache::data rows(mustache::data::type::list);
  for (const Metric& metric : run.metrics()) {
    mustache::data row;
    row.set("name", metric.name);
    row.set("value", format_number(metric.value));
    row.set("unit", metric.unit);
    const auto found = printed.find(metric.name);
    if (found != printed.end()) {
      mustache::data filled;
      filled.set("value", found->second.result.text());
      const Verdict verdict = found->second.verdict(metric.value);
      filled.set("verdict", text(verdict));
      filled.set("verdict_class", css_class(verdict));
      row.set("printed", filled);
    }
    rows << row;
  }
  return rows;
}

}  // namespace

std::vector<PageChart> all_charts(const SavedRun& run, const std::string& id) {
  std::vector<PageChart> charts;
  std::map<std::string, std::size_t> of_scalars;  // stem and unit: the chart
  for (const LogEntry& entry : run.signals()) {
    if (entry.name == "qpos" || entry.rows == 0) continue;
    const std::string path = entry.group + "/" + entry.name;
    const std::string name = entry.group == "control" ? entry.name : path;
    const std::string key = entry.group + "/" + stem(entry.name) + " " + entry.unit;
    const auto found = of_scalars.find(key);
    if (entry.width == 1 && found != of_scalars.end()) {
      charts[found->second].series.push_back(
          {name, entry.unit, entry.description, run.signal(path)});
      continue;
    }
    PageChart chart;
    chart.id = fmt::format("{}-{}", id, charts.size() + 1);
    chart.group = id;
    chart.title = entry.width == 1 ? stem(name) : name;
    for (std::size_t i = 1; i <= entry.width; ++i) {
      const std::string one = entry.width == 1 ? "" : fmt::format("[{}]", i);
      chart.series.push_back(
          {name + one, entry.unit_of(i), entry.description, run.signal(path + one)});
    }
    if (entry.width == 1) of_scalars[key] = charts.size();
    charts.push_back(std::move(chart));
  }
  return charts;
}

std::map<std::string, PrintedValue> printed_of(const Catalogue& catalogue, const SavedRun& run) {
  std::map<std::string, PrintedValue> printed;
  try {
    const ScenarioFile file((run.folder() / "config.toml").string(), run.scenario());
    if (!prepare_run(catalogue, run.scenario(), file, run.case_name(), {}).is_as_shipped)
      return printed;
  } catch (const std::invalid_argument&) {
    return printed;  // of another version, say
  }
  for (const PrintedValue& value : printed_values(run.scenario(), run.case_name())) {
    printed.emplace(value.metric, value);
  }
  return printed;
}

std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs) {
  const std::vector<std::string> labels = labels_of(runs);
  mustache::data page;
  mustache::data toc(mustache::data::type::list);
  mustache::data sections(mustache::data::type::list);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const SavedRun& run = runs[i];
    const std::string id = fmt::format("run-{}", i + 1);
    mustache::data entry;
    entry.set("href", id);
    entry.set("label", labels[i]);
    toc << entry;

    mustache::data section;
    section.set("anchor", id);
    section.set("label", labels[i]);
    section.set("scenario", run.scenario());
    section.set("case", run.case_name());
    section.set("seed", run.seed());
    section.set("folder", run.folder().string());
    section.set("command", fmt::format("{} run {} --config {} --out again", own_program_name(),
                                       run.scenario(), (run.folder() / "config.toml").string()));
    section.set("config", run.config_text());
    if (run.failure()) {
      section.set("failure", fmt::format("This run failed at {:.6g} s: {}. It has no metrics.",
                                         run.failure()->time_s, run.failure()->reason));
    } else {
      section.set("metrics", metrics_data(catalogue, run));
      section.set("has_metrics", true);
    }
    // A run of another program's scenario: what its video shows only that program knows.
    if (catalogue.has<ScenarioKind>(run.scenario())) {
      if (const auto video = video_data(catalogue, run, id)) section.set("video", *video);
    }
    mustache::data charts(mustache::data::type::list);
    for (const PageChart& chart : all_charts(run, id)) charts << chart_data(chart);
    section.set("charts", charts);
    sections << section;
  }
  page.set("title", runs.size() == 1 ? "Run " + labels[0] : fmt::format("{} runs", runs.size()));
  page.set("toc", toc);
  page.set("sections", sections);
  return html_page("runs", page);
}

std::vector<std::string> labels_of(const std::vector<SavedRun>& runs) {
  std::vector<std::string> cases;
  std::vector<std::string> folders;
  std::vector<std::string> paths;
  for (const SavedRun& run : runs) {
    const fs::path folder = fs::absolute(run.folder()).lexically_normal();
    cases.push_back(run.case_name());
    folders.push_back((folder.has_filename() ? folder : folder.parent_path()).filename().string());
    paths.push_back(run.folder().string());
  }
  for (const auto& names : {cases, folders}) {
    if (std::set<std::string>(names.begin(), names.end()).size() == runs.size()) return names;
  }
  return paths;
}

}  // namespace breakwater
