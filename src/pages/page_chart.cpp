#include <breakwater/pages/page_chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include <breakwater/pages/decimation.h>
#include <breakwater/pages/html_page.h>

namespace breakwater {
namespace {

constexpr std::size_t kBuckets = 400;

// The first window gets as many points as the rest.
Series thinned(const Series& series, const std::optional<double>& from_s,
               const std::optional<double>& to_s) {
  if (!from_s || !to_s || series.times_s.empty()) return decimate(series, kBuckets);
  Series thin;
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] :
       {std::pair(-infinity, std::nextafter(*from_s, -infinity)), std::pair(*from_s, *to_s),
        std::pair(std::nextafter(*to_s, infinity), infinity)}) {
    const Series part = decimate(cut(series, from, to), kBuckets);
    thin.times_s.insert(thin.times_s.end(), part.times_s.begin(), part.times_s.end());
    thin.values.insert(thin.values.end(), part.values.begin(), part.values.end());
  }
  return thin;
}

// Differences of whole multiples of a unit; null where there is no number.
nlohmann::json differences(const std::vector<double>& values, double first, double unit) {
  nlohmann::json all = nlohmann::json::array();
  long long last = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) {
      all.push_back(nullptr);
      continue;
    }
    const long long now = std::llround((value - first) / unit);
    all.push_back(now - last);
    last = now;
  }
  return all;
}

nlohmann::ordered_json series_json(const ChartSeries& series, Identity identity,
                                   const Series& thin) {
  constexpr double kMicrosecond = 1e-6, kSteps = 1e5;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : thin.values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  const double unit = high > low ? (high - low) / kSteps : 1.0;
  const double first = low <= high ? low : 0.0;
  return {{"label", series.label},
          {"unit", series.unit == "1" ? "" : series.unit},
          {"about", series.description},
          {"colour", identity < 0 ? kIdentityColours : identity % kIdentityColours},
          {"dash", dash_number(identity)},
          {"off", series.is_off},
          {"t", differences(thin.times_s, 0.0, kMicrosecond)},
          {"from", first},
          {"step", unit},
          {"v", differences(thin.values, first, unit)}};
}

}  // namespace

std::string PageChart::axis_title() const {
  if (series.empty()) return title;
  const std::string& unit = series.front().unit;
  const bool is_common = std::all_of(series.begin(), series.end(),
                                     [&](const ChartSeries& s) { return s.unit == unit; });
  return is_common && !unit.empty() && unit != "1" ? fmt::format("{} [{}]", title, unit) : title;
}

std::string PageChart::alternative_text() const {
  std::string text = fmt::format("Chart of {} over time", axis_title());
  for (const ChartSeries& one : series) {
    if (one.values.values.empty()) {
      text += "; " + one.label;
      continue;
    }
    const auto [low, high] =
        std::minmax_element(one.values.values.begin(), one.values.values.end());
    text += fmt::format("; {} from {:.3g} to {:.3g}", one.label, *low, *high);
    if (!one.unit.empty() && one.unit != "1") text += " " + one.unit;
  }
  return text;
}

std::string PageChart::json() const {
  nlohmann::ordered_json json;
  json["title"] = axis_title();
  json["lines"] = lines;
  if (from_s && to_s) json["window"] = {*from_s, *to_s};
  json["series"] = nlohmann::json::array();
  std::vector<std::optional<Identity>> preferred;
  for (const ChartSeries& one : series) preferred.push_back(one.identity);
  const std::vector<Identity> identities = distinct_identities(preferred);
  for (std::size_t i = 0; i < series.size(); ++i) {
    json["series"].push_back(
        series_json(series[i], identities[i], thinned(series[i].values, from_s, to_s)));
  }
  return script_json(json);
}

}  // namespace breakwater
