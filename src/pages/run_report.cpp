#include <breakwater/pages/run_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/experiment/command_kind.h>
#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pages/signal_charts.h>
#include <breakwater/shell/child_program.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
namespace {

mustache::data metrics_data(const Catalogue& catalogue, const SavedRun& run) {
  const auto printed = printed_of(catalogue, run);
  mustache::data rows(mustache::data::type::list);
  for (const Metric& metric : run.metrics()) {
    mustache::data row;
    row.set("name", metric.name);
    row.set("value", format_number(metric.value));
    row.set("unit", metric.unit);
    const auto found = printed.find(metric.name);
    if (found != printed.end()) {
      mustache::data filled;
      filled.set("value", found->second.text);
      const Agreement agreement = found->second.agrees(metric.value);
      filled.set("verdict", agreement.text);
      filled.set("verdict_class", agreement.tone);
      row.set("printed", filled);
    }
    rows << row;
  }
  return rows;
}

}  // namespace

std::map<std::string, ReferenceValue> printed_of(const Catalogue& catalogue, const SavedRun& run) {
  std::map<std::string, ReferenceValue> printed;
  try {
    const ScenarioFile file((run.folder() / "config.toml").string(), run.scenario());
    if (!prepare_run(catalogue, run.scenario(), file, run.case_name(), {}).is_as_shipped)
      return printed;
  } catch (const std::invalid_argument&) {
    return printed;  // the case may be from another version
  }
  for (ReferenceValue& value : reference_values(catalogue, run.scenario(), run.case_name())) {
    printed.emplace(value.metric, std::move(value));
  }
  return printed;
}

void set_changed_keys(const Catalogue& catalogue, const SavedRun& run, mustache::data& section) {
  mustache::data rows(mustache::data::type::list);
  const std::vector<ChangedKey> changed = changed_keys(catalogue, run);
  for (const ChangedKey& key : changed) {
    mustache::data row;
    row.set("key", key.key);
    row.set("value", key.value);
    row.set("shipped", key.shipped);
    rows << row;
  }
  section.set("keys", rows);
  section.set("has_keys", !changed.empty());
}

std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs,
                       const RunReportOptions& options, std::vector<std::string>& notes) {
  const std::vector<std::string> labels = labels_of(catalogue, runs);
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
    // A run that a command made is repeated with that command.
    const bool has_command = catalogue.has<CommandKind>(run.scenario());
    section.set("command", fmt::format("{} {}{} --config {} --out again", own_program_name(),
                                       has_command ? "" : "run ", run.scenario(),
                                       (run.folder() / "config.toml").string()));
    section.set("config", run.config_text());
    set_changed_keys(catalogue, run, section);
    if (run.failure()) {
      section.set("failure", fmt::format("This run failed at {:.6g} s: {}. It has no metrics.",
                                         run.failure()->time_s, run.failure()->reason));
    } else {
      section.set("metrics", metrics_data(catalogue, run));
      section.set("has_metrics", true);
      section.set("has_printed", !printed_of(catalogue, run).empty());
    }
    std::optional<ReplayPart> replay;
    if (options.with_replay) {
      replay = replay_of(catalogue, {run.folder()}, {labels[i]}, {id + "-replay", id, ""}, notes);
    }
    ShotList shots;
    std::optional<Window> window;
    if (replay) {
      section.set("replay", replay->box);
      page.set("has_replays", true);
      shots = replay->shots;
      window = replay->window;
    } else if (catalogue.has<ScenarioKind>(run.scenario())) {
      if (const auto video = video_data(catalogue, run, id)) section.set("video", *video);
    }
    mustache::data charts(mustache::data::type::list);
    if (replay && replay->chart) charts << chart_data(*replay->chart);
    for (PageChart& chart : signal_charts(run, id, shots)) {
      if (window) {
        chart.from_s = window->from_s;
        chart.to_s = window->to_s;
      }
      charts << chart_data(chart);
    }
    if (replay && !replay->is_whole) section.set("window", window_data(replay->window, id));
    section.set("charts", charts);
    sections << section;
  }
  page.set("title", runs.size() == 1 ? "Run " + labels[0] : fmt::format("{} runs", runs.size()));
  page.set("toc", toc);
  page.set("sections", sections);
  return html_page("runs", page);
}

}  // namespace breakwater
