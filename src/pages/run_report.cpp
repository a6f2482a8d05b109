#include <breakwater/pages/run_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>

#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/references.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/pages/compare.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pages/signal_charts.h>
#include <breakwater/shell/child_program.h>

namespace breakwater {
namespace {

constexpr std::size_t kFewestKeys = 4;

// The reference values of a run by metric. Empty unless the run has the settings of one of the
// project's own cases: other settings make the comparison meaningless.
std::map<std::string, PublishedValue> printed_of(const Catalogue& catalogue, const SavedRun& run) {
  try {
    const ScenarioFile file((run.folder() / "config.toml").string(), run.scenario());
    const PreparedRun again = prepare_run(catalogue, run.scenario(), file, run.case_name(), {});
    if (!is_as_shipped(catalogue, again)) return {};
  } catch (const std::invalid_argument&) {
    return {};  // the case may be from another version
  }
  return published_values(catalogue, run.scenario(), run.case_name());
}

// In the cell of a metric: "thesis 2.83", and below it whether the measured value agrees.
void add_printed(PageData& cell, const PublishedValue& reference,
                 const std::optional<double>& measured) {
  cell["printed"] = reference.number;
  cell["printed_text"] = reference.text;
  if (!measured) return;
  const Agreement agreement = reference.agrees(*measured);
  cell["lines"].push_back({{"text", "thesis " + reference.text}, {"kind", "printed"}});
  cell["lines"].push_back({{"text", agreement.text + ": " + reference.deviation(*measured)},
                           {"kind", "verdict " + agreement.tone},
                           {"tip", agreement.rule}});
}

// The keys in which a run differs from its case.
PageData changed_table(const Catalogue& catalogue, const SavedRun& run) {
  auto rows = PageData::array();
  for (const DifferingKey& key :
       changed_keys(catalogue, run.folder(), run.scenario(), run.case_name())) {
    rows.push_back(PageData::array({key.key, key.values[0], key.values[1]}));
  }
  return {{"label", "Keys that differ from the case"},
          {"kind", "numbers keys-table"},
          {"columns", {"differs from the case", "here", "as shipped"}},
          {"rows", rows}};
}

}  // namespace

std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs,
                       bool with_replay, std::vector<std::string>& notes) {
  const std::vector<std::string> labels = labels_of(catalogue, runs);
  const bool is_one = runs.size() == 1;
  auto toc = PageData::array();
  auto sections = PageData::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const SavedRun& run = runs[i];
    const std::string id = fmt::format("run-{}", i + 1);
    const bool has_scenario = catalogue.has<ScenarioKind>(run.scenario());
    const ShotList shots = shots_of(catalogue, run);
    auto blocks = PageData::array();
    const auto titled = [&](const std::string& part, const std::string& heading) {
      blocks.push_back({{"subheading", heading}, {"id", id + part}});
      if (is_one) toc.push_back({{"href", id + part}, {"label", heading}});
    };
    const std::string about =
        has_scenario ? make_scenario(catalogue, run.scenario())->summary() + " · " : "";
    blocks.push_back(
        {{"about", fmt::format("{}seed {}", about, run.seed())}, {"tip", run.folder().string()}});
    auto card = PageData::array(), rows = PageData::array();
    if (run.failure()) {
      add_block(blocks, "failure",
                fmt::format("This run {} at {:.6g} s: {}. It has no metrics.",
                            run.failure()->verb(), run.failure()->time_s, run.failure()->reason));
    } else {
      for (PageData row : metric_rows(catalogue, {&run, 1}, shots, run.metrics(), labels[i])) {
        const PageData name = row[0];
        PageData unit = name["unit"];
        if (unit == "1") unit = "";
        if (name["is_key"] == true) {
          card.push_back(row[1]);
          card.back().update({{"name", name["value"]}, {"tip", name["tip"]}, {"unit", unit}});
        }
        row.push_back(unit);
        rows.push_back(row);
      }
      add_block(blocks, "card", card);
    }
    const PageData changed = changed_table(catalogue, run);
    if (!changed["rows"].empty()) add_block(blocks, "table", changed);
    std::optional<ReplayPart> replay;
    if (with_replay) replay = replay_of(catalogue, {&run, 1}, id, notes);
    std::optional<Window> window;
    if (replay) {
      add_block(blocks, "replay", replay->box);
      window = replay->window;
    }
    const SignalCharts charts = signal_charts(run, id, shots);
    titled("-signals", "Key signals");
    add_block(blocks, "text", "t = 0 is the start of the run.");
    if (replay && !replay->is_whole) blocks.back()["window"] = window_data(replay->window, id);
    add_block(blocks, "figures", figures_of(charts.key, window));
    if (!run.failure()) {
      titled("-metrics", "All metrics");
      add_block(blocks, "table",
                {{"label", "Metrics"}, {"columns", {"metric", "value", "unit"}}, {"rows", rows}});
    }
    if (!charts.others.empty()) {
      add_other_charts(blocks, id + "-all", charts.others, window);
      if (is_one) toc.push_back({{"href", id + "-all"}, {"label", "All signals"}});
    }
    // A run that a command made is repeated with that command.
    const bool has_command = catalogue.has<CommandKind>(run.scenario());
    add_block(blocks, "code",
              {{"summary", "Command"},
               {"text", fmt::format("{} {}{} --config {} --out again", own_program_name(),
                                    has_command ? "" : "run ", run.scenario(),
                                    (run.folder() / "config.toml").string())}});
    add_block(blocks, "code", {{"summary", "Configuration"}, {"text", run.config_text()}});
    PageData section = {{"id", id}, {"kind", "run"}, {"blocks", blocks}};
    if (!is_one) section.update({{"heading", labels[i]}, {"scenario", run.scenario()}});
    sections.push_back(section);
  }
  PageData page = {{"title", is_one ? labels[0] : fmt::format("{} runs", runs.size())},
                   {"sections", sections}};
  if (is_one) page.update({{"scenario", runs.front().scenario()}, {"toc", toc}});
  return html_page("runs", page);
}

PageData metric_rows(const Catalogue& catalogue, std::span<const SavedRun> runs,
                     const ShotList& shots, const std::vector<Metric>& metrics,
                     const std::string& first_label) {
  const std::string& scenario = runs.front().scenario();
  std::vector<std::string> keys = shots.page.metrics;
  std::vector<MetricDefinition> definitions;
  if (catalogue.has<ScenarioKind>(scenario)) {
    const auto made = make_scenario(catalogue, scenario);
    definitions = made->metric_definitions();
    if (keys.empty()) keys = made->main_metrics();
  }
  std::vector<std::map<std::string, PublishedValue>> printed;
  for (const SavedRun& run : runs) printed.push_back(printed_of(catalogue, run));
  auto rows = PageData::object();
  const auto add = [&](const Metric& metric, bool is_key) {
    if (rows.contains(metric.name)) return;
    const auto found = std::ranges::find(definitions, metric.name, &MetricDefinition::name);
    PageData& row = rows[metric.name];
    row.push_back({{"value", metric.name},
                   {"unit", metric.unit},
                   {"tip", found == definitions.end() ? "" : found->text},
                   {"is_key", is_key}});
    std::vector<std::optional<double>> values;
    for (const SavedRun& run : runs) values.push_back(run.metric(metric.name));
    const std::vector<std::string> words = differences_in_words(values);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      PageData cell = {{"value", nullptr},
                       {"difference", nullptr},
                       {"in_words", words[i]},
                       {"printed", nullptr},
                       {"lines", PageData::array()}};
      if (values[i]) cell["value"] = *values[i];
      if (values[i] && values[0]) {
        cell["difference"] = *values[i] - *values[0];
        const char* to = words[i] == "same" ? "as" : "vs";
        const std::string line = fmt::format("{} {} {}", words[i], to, first_label);
        if (i > 0) cell["lines"].push_back({{"text", line}, {"kind", "spread"}});
      }
      const auto reference = printed[i].find(metric.name);
      if (reference != printed[i].end()) add_printed(cell, reference->second, values[i]);
      row.push_back(cell);
    }
  };
  for (const Metric& metric : main_metrics(keys, metrics)) add(metric, true);
  for (const Metric& metric : metrics) {
    add(metric, shots.page.metrics.empty() && rows.size() < kFewestKeys);
  }
  return rows;
}

PageData figures_of(const std::vector<PageChart>& charts, const std::optional<Window>& window) {
  auto figures = PageData::array();
  for (PageChart chart : charts) {
    chart.window = window;
    figures.push_back(figure_of(chart));
  }
  return figures;
}

void add_other_charts(PageData& blocks, const std::string& id, const std::vector<PageChart>& charts,
                      const std::optional<Window>& window) {
  auto folded = PageData::array();
  add_block(folded, "figures", figures_of(charts, window));
  add_block(blocks, "fold",
            {{"id", id},
             {"summary", fmt::format("All signals: {} more charts", charts.size())},
             {"blocks", folded}});
}

ShotList shots_of(const Catalogue& catalogue, const SavedRun& run) {
  if (!catalogue.has<ScenarioKind>(run.scenario())) return {};
  try {
    const ScenarioFile file((run.folder() / "config.toml").string(), run.scenario());
    return shot_list(
        shots_file(catalogue.get<ScenarioKind>(run.scenario()), file.config(run.case_name())));
  } catch (const std::invalid_argument&) {
    return {};  // the order is then that of the log
  }
}

}  // namespace breakwater
