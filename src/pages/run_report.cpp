#include <breakwater/pages/run_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/experiment/command_kind.h>
#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/key_metrics.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pages/signal_charts.h>
#include <breakwater/shell/child_program.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
namespace {

void add_metrics(const Catalogue& catalogue, const SavedRun& run, const ShotList& shots,
                 mustache::data& section) {
  const auto printed = printed_of(catalogue, run);
  mustache::data rows(mustache::data::type::list), keys(mustache::data::type::list);
  for (const ShownMetric& shown : shown_metrics(catalogue, run.scenario(), shots, run.metrics())) {
    mustache::data row;
    set_name(shown, row);
    row.set("value", format_number(shown.metric.value));
    const auto found = printed.find(shown.metric.name);
    if (found != printed.end()) {
      mustache::data filled;
      filled.set("value", found->second.text);
      const Agreement agreement = found->second.agrees(shown.metric.value);
      filled.set("verdict", agreement.text);
      filled.set("verdict_class", agreement.tone);
      filled.set("rule", agreement.rule);
      row.set("printed", filled);
    }
    rows << row;
    if (shown.is_key) keys << row;
  }
  section.set("metrics", rows);
  section.set("key_metrics", keys);
  section.set("has_metrics", true);
  section.set("has_printed", !printed.empty());
}

// Adds a reference that is a key of the run and no signal: the shot list's lines have it.
void add_reference(const PageChart& shown, std::vector<PageChart>& charts) {
  for (const ChartSeries& series : shown.series) {
    if (series.identity != kReferenceIdentity || charts.empty()) continue;
    PageChart& first = charts.front();
    const auto has_one =
        std::any_of(first.series.begin(), first.series.end(),
                    [](const ChartSeries& one) { return one.identity == kReferenceIdentity; });
    if (!has_one && first.series.front().unit == series.unit) first.series.push_back(series);
  }
}

mustache::data chart_list(std::vector<PageChart>& charts, const std::optional<Window>& window) {
  mustache::data list(mustache::data::type::list);
  for (PageChart& chart : charts) {
    if (window) {
      chart.from_s = window->from_s;
      chart.to_s = window->to_s;
    }
    list << chart_data(chart);
  }
  return list;
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
    const auto contents = [&](const std::string& part, const std::string& label) {
      mustache::data entry;
      entry.set("href", id + part);
      entry.set("label", label);
      toc << entry;
    };
    if (runs.size() > 1) {
      contents("", labels[i]);
    } else {
      contents("-signals", "Key signals");
      if (!run.failure()) contents("-metrics", "All metrics");
      contents("-all", "All signals");
    }

    const ShotList shots = shots_of(catalogue, run.scenario());
    mustache::data section;
    section.set("anchor", id);
    if (runs.size() > 1) section.set("label", labels[i]);
    section.set("scenario", run.scenario());
    if (catalogue.has<ScenarioKind>(run.scenario())) {
      section.set("about", make_scenario(catalogue, run.scenario())->summary());
    }
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
      section.set("failure",
                  fmt::format("This run {} at {:.6g} s: {}. It has no metrics.",
                              run.failure()->verb(), run.failure()->time_s, run.failure()->reason));
    } else {
      add_metrics(catalogue, run, shots, section);
    }
    std::optional<ReplayPart> replay;
    if (options.with_replay) {
      replay = replay_of(catalogue, {run.folder()}, {labels[i]}, {id + "-replay", id, ""}, notes);
    }
    std::optional<Window> window;
    if (replay) {
      section.set("replay", replay->box);
      page.set("has_replays", true);
      window = replay->window;
    } else if (catalogue.has<ScenarioKind>(run.scenario())) {
      if (const auto video = video_data(catalogue, run, id)) section.set("video", *video);
    }
    SignalCharts charts = signal_charts(run, id, shots);
    if (replay && replay->chart) add_reference(*replay->chart, charts.key);
    if (replay && !replay->is_whole) section.set("window", window_data(replay->window, id));
    section.set("charts", chart_list(charts.key, window));
    mustache::data others = chart_list(charts.others, window);
    section.set("other_count", std::to_string(charts.others.size()));
    section.set("has_others", !charts.others.empty());
    section.set("others", others);
    section.set("constants", fmt::format("{}", fmt::join(charts.constants, ", ")));
    section.set("has_constants", !charts.constants.empty());
    sections << section;
  }
  page.set("title", runs.size() == 1 ? labels[0] : fmt::format("{} runs", runs.size()));
  if (runs.size() == 1) page.set("of_scenario", runs.front().scenario());
  page.set("toc", toc);
  page.set("sections", sections);
  return html_page("runs", page);
}

}  // namespace breakwater
