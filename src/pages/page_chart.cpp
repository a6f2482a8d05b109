#include <breakwater/pages/page_chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include <breakwater/pages/decimation.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pictures/page_data.h>

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

std::string packed(const std::vector<double>& values) {
  const std::vector<float> narrow(values.begin(), values.end());
  return base64(narrow.data(), narrow.size() * sizeof(float));
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
    if (one.values.values.empty()) continue;
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
  for (const ChartSeries& one : series) {
    const Series thin = thinned(one.values, from_s, to_s);
    json["series"].push_back({{"label", one.label},
                              {"unit", one.unit == "1" ? "" : one.unit},
                              {"about", one.description},
                              {"reference", one.is_reference},
                              {"off", one.is_off},
                              {"colour", one.colour},
                              {"t", packed(thin.times_s)},
                              {"v", packed(thin.values)}});
  }
  return script_json(json);
}

}  // namespace breakwater
