#include <breakwater/pages/run_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pages/signal_charts.h>
#include <breakwater/shell/child_program.h>

namespace breakwater {
namespace {

constexpr std::size_t kFewestKeys = 4;

// The key metrics as a card, and all as a table.
std::pair<PageData, PageData> metrics_of(const Catalogue& catalogue, const SavedRun& run,
                                         const ShotList& shots) {
  const auto printed = printed_of(catalogue, run);
  auto rows = PageData::array();
  auto card = PageData::array();
  for (const ShownMetric& shown : shown_metrics(catalogue, run.scenario(), shots, run.metrics())) {
    const double value = shown.metric.value;
    const std::string unit = shown.metric.unit == "1" ? "" : shown.metric.unit;
    PageData cell = {{"value", value}};
    const auto found = printed.find(shown.metric.name);
    if (found != printed.end()) cell["lines"] = printed_lines(found->second, value);
    rows.push_back(
        PageData::array({{{"value", shown.metric.name}, {"tip", shown.about}}, cell, unit}));
    cell.update({{"name", shown.metric.name}, {"tip", shown.about}, {"unit", unit}});
    if (shown.is_key) card.push_back(cell);
  }
  return {card, {{"label", "Metrics"}, {"columns", {"metric", "value", "unit"}}, {"rows", rows}}};
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
    PageData table;
    if (run.failure()) {
      add_block(blocks, "failure",
                fmt::format("This run {} at {:.6g} s: {}. It has no metrics.",
                            run.failure()->verb(), run.failure()->time_s, run.failure()->reason));
    } else {
      PageData card;
      std::tie(card, table) = metrics_of(catalogue, run, shots);
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
      add_block(blocks, "table", table);
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

std::vector<ShownMetric> shown_metrics(const Catalogue& catalogue, const std::string& scenario,
                                       const ShotList& shots, const std::vector<Metric>& metrics) {
  std::vector<std::string> names = shots.page.metrics;
  std::vector<MetricDefinition> definitions;
  if (catalogue.has<ScenarioKind>(scenario)) {
    const auto made = make_scenario(catalogue, scenario);
    definitions = made->metric_definitions();
    if (names.empty()) names = made->main_metrics();
  }
  std::vector<ShownMetric> all;
  const auto add = [&](const Metric& metric, bool is_key) {
    const auto name_of = [](const ShownMetric& one) { return one.metric.name; };
    if (std::ranges::find(all, metric.name, name_of) != all.end()) return;
    const auto found = std::ranges::find(definitions, metric.name, &MetricDefinition::name);
    all.push_back({metric, found == definitions.end() ? "" : found->text, is_key});
  };
  for (const Metric& metric : main_metrics(names, metrics)) add(metric, true);
  for (const Metric& metric : metrics) {
    add(metric, shots.page.metrics.empty() && all.size() < kFewestKeys);
  }
  return all;
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

PageData printed_lines(const PublishedValue& reference, double measured) {
  const Agreement agreement = reference.agrees(measured);
  return {{{"text", "thesis " + reference.text}, {"kind", "printed"}},
          {{"text", agreement.text + ": " + reference.deviation(measured)},
           {"kind", "verdict " + agreement.tone},
           {"tip", agreement.rule}}};
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
