#include <breakwater/pages/key_metrics.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/experiment/main_metrics.h>
#include <breakwater/pages/labels.h>

namespace breakwater {
namespace {

constexpr std::size_t kFewestKeys = 4;

}  // namespace

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
    const auto is_same = [&](const auto& one) { return one.name == metric.name; };
    if (std::any_of(all.begin(), all.end(),
                    [&](const ShownMetric& one) { return is_same(one.metric); }))
      return;
    const auto found = std::find_if(definitions.begin(), definitions.end(), is_same);
    all.push_back({metric, metric_label(metric.name, metric.unit),
                   metric.name + (found == definitions.end() ? "" : ": " + found->text), is_key});
  };
  for (const Metric& metric : main_metrics(names, metrics)) add(metric, true);
  for (const Metric& metric : metrics) {
    add(metric, shots.page.metrics.empty() && all.size() < kFewestKeys);
  }
  return all;
}

void set_name(const ShownMetric& shown, PageData& row) {
  row["name"] = shown.label;
  if (!shown.metric.unit.empty() && shown.metric.unit != "1") row["unit"] = shown.metric.unit;
  row["about"] = shown.about;
}

ShotList shots_of(const Catalogue& catalogue, const std::string& scenario) {
  if (!catalogue.has<ScenarioKind>(scenario)) return {};
  try {
    return shot_list(catalogue.get<ScenarioKind>(scenario).shots());
  } catch (const std::invalid_argument&) {
    return {};  // the order is then that of the log
  }
}

}  // namespace breakwater
