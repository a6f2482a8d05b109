#include <breakwater/report/page_chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include <breakwater/report/decimation.h>

namespace breakwater {
namespace {

constexpr std::size_t kBuckets = 400;

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
  json["series"] = nlohmann::json::array();
  for (const ChartSeries& one : series) {
    const Series thin = decimate(one.values, kBuckets);
    json["series"].push_back({{"label", one.label},
                              {"unit", one.unit == "1" ? "" : one.unit},
                              {"about", one.description},
                              {"reference", one.is_reference},
                              {"off", one.is_off},
                              {"t", packed(thin.times_s)},
                              {"v", packed(thin.values)}});
  }
  std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

std::string base64(const void* bytes, std::size_t size) {
  static constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* data = static_cast<const unsigned char*>(bytes);
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = std::min<std::size_t>(3, size - i);
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8U | (k < left ? data[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= left ? kDigits[word >> (18U - 6U * static_cast<unsigned>(k)) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace breakwater
