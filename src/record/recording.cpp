#include <breakwater/record/recording.h>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <breakwater/record/text_outputs.h>

namespace breakwater {

Metric::Metric(std::string its_name, std::string its_unit, double its_value)
    : name(std::move(its_name)), unit(std::move(its_unit)), value(its_value) {
  if (!is_column_name(name)) {
    throw std::invalid_argument("a metric cannot be named \"" + name + "\": " + kColumnName);
  }
}

const Track& Recording::track(const std::string& name) const {
  const auto found = std::ranges::find(tracks, name, &Track::name);
  if (found == tracks.end()) throw std::out_of_range("recording has no track " + name);
  return *found;
}

std::optional<double> metric_in(const std::vector<Metric>& metrics, const std::string& name) {
  const auto found = std::ranges::find(metrics, name, &Metric::name);
  if (found == metrics.end()) return std::nullopt;
  return found->value;
}

std::vector<Metric> main_metrics(const std::vector<std::string>& names,
                                 const std::vector<Metric>& metrics) {
  constexpr std::size_t kFew = 2;
  if (names.empty())
    return {metrics.begin(),
            metrics.begin() + static_cast<std::ptrdiff_t>(std::min(kFew, metrics.size()))};
  std::vector<Metric> found;
  for (const std::string& name : names) {
    const auto metric = std::ranges::find(metrics, name, &Metric::name);
    if (metric != metrics.end()) found.push_back(*metric);
  }
  return found;
}

std::string brief(const std::vector<Metric>& metrics) {
  std::string text;
  for (const Metric& metric : metrics) {
    text += fmt::format("{}{} {:.4g}", text.empty() ? "" : "  ", metric.name, metric.value);
  }
  return text;
}

}  // namespace breakwater
