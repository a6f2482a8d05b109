#include <breakwater/experiment/run_tables.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <breakwater/experiment/references.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

constexpr const char* kChanged =
    "its settings differ from Breakwater's case of this name: no comparison with the printed "
    "values\n";

// The printed values of a run's case, if the run has the shipped settings.
std::map<std::string, PublishedValue> printed_for(const Catalogue& catalogue,
                                                  const std::string& scenario,
                                                  const RunSummary& run) {
  if (!run.is_as_shipped) return {};
  return published_values(catalogue, scenario, run.case_name);
}

bool is_changed(const Catalogue& catalogue, const std::string& scenario, const RunSummary& run) {
  return !run.is_as_shipped && !published_values(catalogue, scenario, run.case_name).empty();
}

std::string with_legend(const Catalogue& catalogue, const std::string& text) {
  if (text.find(" *") == std::string::npos) return text;
  std::string legend;
  for (const ReferenceKind& source : catalogue.all<ReferenceKind>()) legend += source.legend;
  return legend + text;
}

// "+1.2 %", with a mark if the number does not agree.
std::string marked_deviation(const PublishedValue& printed, double measured) {
  return printed.deviation(measured) + (printed.agrees(measured).is_met ? "" : " *");
}

}  // namespace

std::string metrics_table(const std::string& scenario, const RunSummary& run,
                          const Catalogue& catalogue) {
  const auto printed = printed_for(catalogue, scenario, run);
  std::vector<std::string> header = {"metric", "value", "unit"};
  if (!printed.empty()) header.insert(header.end(), {"printed", "deviation"});
  TextRows rows = {header};
  for (const Metric& metric : run.metrics) {
    std::vector<std::string> row = {metric.name, in_digits(metric.value), metric.unit};
    if (const auto value = printed.find(metric.name); value != printed.end()) {
      row.push_back(value->second.text);
      row.push_back(marked_deviation(value->second, metric.value));
    }
    rows.push_back(row);
  }
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;  // with their metrics
  for (const AbsentMetric& metric : run.absent) {
    rows.push_back({metric.name, "–", metric.unit});
    auto known = std::ranges::find(reasons, metric.reason, &decltype(reasons)::value_type::first);
    if (known == reasons.end()) known = reasons.insert(known, {metric.reason, {}});
    known->second.push_back(metric.name);
  }
  std::string text = in_columns(std::move(rows), std::numeric_limits<std::size_t>::max());
  if (!reasons.empty()) text += "\n";
  for (const auto& [reason, names] : reasons) {
    text += fmt::format("{}: {}\n", fmt::join(names, ", "), reason);
  }
  if (run.metrics.empty() && run.absent.empty()) {
    text = "no metric: the file has no row [metric.NAME], or the run is too short for its rows\n";
  }
  if (is_changed(catalogue, scenario, run)) text = kChanged + text;
  return with_legend(catalogue, text);
}

std::string matrix_tables(const Matrix& matrix, const std::vector<RunSummary>& runs,
                          std::size_t width) {
  const std::size_t cases = runs.size() / matrix.values.size();
  std::string text;
  for (const std::string& name : matrix.metrics) {
    std::vector<std::string> header = {name + " by " + matrix.key};
    header.insert(header.end(), matrix.values.begin(), matrix.values.end());
    TextRows rows = {header};
    for (std::size_t i = 0; i < cases; ++i) {
      std::vector<std::string> row = {runs[i].case_name};
      for (std::size_t j = 0; j < matrix.values.size(); ++j) {
        const RunSummary& run = runs[j * cases + i];
        const std::optional<double> value = run.metric(name);
        row.push_back(value ? in_digits(*value) : run.failure ? "failed" : "-");
      }
      rows.push_back(row);
    }
    if (!text.empty()) text += '\n';
    text += in_columns(std::move(rows), width);
  }
  return text;
}

std::string comparison_table(const std::string& scenario, const std::vector<RunSummary>& runs,
                             const Catalogue& catalogue, std::size_t width) {
  std::vector<Metric> metrics;  // the ones of all runs, in their order
  for (const RunSummary& run : runs) {
    auto position = metrics.begin();
    for (const Metric& metric : run.metrics) {
      const auto found = std::ranges::find(metrics, metric.name, &Metric::name);
      position = found != metrics.end() ? found + 1 : metrics.insert(position, metric) + 1;
    }
    for (const AbsentMetric& metric : run.absent) {
      if (std::ranges::find(metrics, metric.name, &Metric::name) == metrics.end()) {
        metrics.emplace_back(metric.name, metric.unit, 0.0);
      }
    }
  }
  std::vector<std::map<std::string, PublishedValue>> printed;
  std::vector<std::string> header = {"metric", "unit"};
  for (const RunSummary& run : runs) {
    printed.push_back(printed_for(catalogue, scenario, run));
    header.push_back(run.case_name);
  }

  TextRows rows = {header};
  for (const Metric& metric : metrics) {
    std::vector<std::string> values = {metric.name, metric.unit};
    std::vector<std::string> printed_row = {"  printed", metric.unit};
    std::vector<std::string> deviations = {"  deviation", ""};
    bool any_printed = false;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::optional<double> measured = runs[i].metric(metric.name);
      const auto value = printed[i].find(metric.name);
      const bool is_printed = value != printed[i].end();
      values.push_back(measured ? in_digits(*measured) : runs[i].failure ? "failed" : "-");
      printed_row.push_back(is_printed ? value->second.text : "-");
      deviations.push_back(is_printed && measured ? marked_deviation(value->second, *measured)
                                                  : "-");
      any_printed |= is_printed;
    }
    rows.push_back(values);
    if (any_printed) {
      rows.push_back(printed_row);
      rows.push_back(deviations);
    }
  }
  std::string text = in_columns(std::move(rows), width, 2);
  const bool any_changed = std::ranges::any_of(
      runs, [&](const RunSummary& run) { return is_changed(catalogue, scenario, run); });
  if (any_changed) text = kChanged + text;
  return with_legend(catalogue, text);
}

}  // namespace breakwater
