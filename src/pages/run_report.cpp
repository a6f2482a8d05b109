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
namespace {

void add_metrics(const Catalogue& catalogue, const SavedRun& run, const ShotList& shots,
                 PageData& section) {
  const auto printed = printed_of(catalogue, run);
  auto rows = PageData::array();
  auto keys = PageData::array();
  for (const ShownMetric& shown : shown_metrics(catalogue, run.scenario(), shots, run.metrics())) {
    PageData row;
    set_name(shown, row);
    row["value"] = format_number(shown.metric.value);
    const auto found = printed.find(shown.metric.name);
    if (found != printed.end()) {
      PageData filled;
      filled["value"] = found->second.text;
      const Agreement agreement = found->second.agrees(shown.metric.value);
      filled["verdict"] = agreement.text;
      filled["verdict_class"] = agreement.tone;
      filled["rule"] = agreement.rule;
      row["printed"] = filled;
    }
    rows.push_back(row);
    if (shown.is_key) keys.push_back(row);
  }
  section["metrics"] = rows;
  section["key_metrics"] = keys;
  section["has_metrics"] = true;
  section["has_printed"] = !printed.empty();
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

PageData chart_list(std::vector<PageChart>& charts, const std::optional<Window>& window) {
  auto list = PageData::array();
  for (PageChart& chart : charts) {
    if (window) {
      chart.from_s = window->from_s;
      chart.to_s = window->to_s;
    }
    list.push_back(chart.json());
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

void set_changed_keys(const Catalogue& catalogue, const SavedRun& run, PageData& section) {
  auto rows = PageData::array();
  const std::vector<ChangedKey> changed = changed_keys(catalogue, run);
  for (const ChangedKey& key : changed) {
    rows.push_back({{"key", key.key}, {"value", key.value}, {"shipped", key.shipped}});
  }
  section["keys"] = rows;
  section["has_keys"] = !changed.empty();
}

std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs,
                       const RunReportOptions& options, std::vector<std::string>& notes) {
  const std::vector<std::string> labels = labels_of(catalogue, runs);
  PageData page;
  auto toc = PageData::array();
  auto sections = PageData::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const SavedRun& run = runs[i];
    const std::string id = fmt::format("run-{}", i + 1);
    const auto contents = [&](const std::string& part, const std::string& label) {
      toc.push_back({{"href", id + part}, {"label", label}});
    };
    if (runs.size() > 1) {
      contents("", labels[i]);
    } else {
      contents("-signals", "Key signals");
      if (!run.failure()) contents("-metrics", "All metrics");
      contents("-all", "All signals");
    }

    const ShotList shots = shots_of(catalogue, run.scenario());
    PageData section;
    section["anchor"] = id;
    if (runs.size() > 1) section["label"] = labels[i];
    section["scenario"] = run.scenario();
    if (catalogue.has<ScenarioKind>(run.scenario())) {
      section["about"] = make_scenario(catalogue, run.scenario())->summary();
    }
    section["seed"] = run.seed();
    section["folder"] = run.folder().string();
    // A run that a command made is repeated with that command.
    const bool has_command = catalogue.has<CommandKind>(run.scenario());
    section["command"] = fmt::format("{} {}{} --config {} --out again", own_program_name(),
                                     has_command ? "" : "run ", run.scenario(),
                                     (run.folder() / "config.toml").string());
    section["config"] = run.config_text();
    set_changed_keys(catalogue, run, section);
    if (run.failure()) {
      section["failure"] =
          fmt::format("This run {} at {:.6g} s: {}. It has no metrics.", run.failure()->verb(),
                      run.failure()->time_s, run.failure()->reason);
    } else {
      add_metrics(catalogue, run, shots, section);
    }
    std::optional<ReplayPart> replay;
    if (options.with_replay) {
      replay = replay_of(catalogue, {run.folder()}, {labels[i]}, {id + "-replay", id, ""}, notes);
    }
    std::optional<Window> window;
    if (replay) {
      section["replay"] = replay->box;
      window = replay->window;
    } else if (catalogue.has<ScenarioKind>(run.scenario())) {
      if (const auto video = video_data(catalogue, run, id)) section["video"] = *video;
    }
    SignalCharts charts = signal_charts(run, id, shots);
    if (replay && replay->chart) add_reference(*replay->chart, charts.key);
    if (replay && !replay->is_whole) section["window"] = window_data(replay->window, id);
    section["charts"] = chart_list(charts.key, window);
    PageData others = chart_list(charts.others, window);
    section["other_count"] = std::to_string(charts.others.size());
    section["has_others"] = !charts.others.empty();
    section["others"] = others;
    section["constants"] = fmt::format("{}", fmt::join(charts.constants, ", "));
    section["has_constants"] = !charts.constants.empty();
    sections.push_back(section);
  }
  page["title"] = runs.size() == 1 ? labels[0] : fmt::format("{} runs", runs.size());
  if (runs.size() == 1) page["of_scenario"] = runs.front().scenario();
  page["toc"] = toc;
  page["sections"] = sections;
  return html_page("runs", page);
}

}  // namespace breakwater
