#include <breakwater/experiment/main_metrics.h>

#include <fmt/format.h>

#include <algorithm>

namespace breakwater {

std::vector<Metric> main_metrics(const std::vector<std::string>& names,
                                 const std::vector<Metric>& metrics) {
  constexpr std::size_t kFew = 2;
  if (names.empty())
    return {metrics.begin(),
            metrics.begin() + static_cast<std::ptrdiff_t>(std::min(kFew, metrics.size()))};
  std::vector<Metric> found;
  for (const std::string& name : names) {
    const auto metric = std::find_if(metrics.begin(), metrics.end(),
                                     [&](const Metric& m) { return m.name == name; });
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
