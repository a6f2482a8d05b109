#include <breakwater/pages/page_chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace breakwater {
namespace {

constexpr std::size_t kBuckets = 400;

// The first window gets as many points as the rest.
Series thinned(const Series& series, const std::optional<Window>& window) {
  if (!window || series.times_s.empty()) return decimate(series, kBuckets);
  Series thin;
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair(-infinity, std::nextafter(window->from_s, -infinity)),
                                 std::pair(window->from_s, window->to_s),
                                 std::pair(std::nextafter(window->to_s, infinity), infinity)}) {
    const Series part = decimate(cut(series, from, to), kBuckets);
    thin.times_s.insert(thin.times_s.end(), part.times_s.begin(), part.times_s.end());
    thin.values.insert(thin.values.end(), part.values.begin(), part.values.end());
  }
  return thin;
}

// Differences of whole multiples of a unit; null where there is no number.
PageData differences(const std::vector<double>& values, double first, double unit) {
  auto all = PageData::array();
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

// Where the values begin, and the unit that divides their range into `steps`.
std::pair<double, double> packing(const std::vector<double>& values, double steps) {
  const auto [low, high] = range_of(values);
  return {std::isnan(low) ? 0.0 : low, high > low ? (high - low) / steps : 1.0};
}

// Whether a range of positive values has a logarithmic axis: it extends over decades.
bool is_for_log(const std::vector<double>& values) {
  constexpr double kWide = 300.0;
  const auto [low, high] = range_of(values);
  return low > 0.0 && high > kWide * low;
}

}  // namespace

PageChart PageChart::scaled() const {
  PageChart chart = *this;
  std::vector<double> x, y;
  for (const ChartSeries& one : series) {
    x.insert(x.end(), one.values.times_s.begin(), one.values.times_s.end());
    for (const auto* values : {&one.values.values, &one.low, &one.high}) {
      y.insert(y.end(), values->begin(), values->end());
    }
  }
  chart.is_log_x = is_log_x || is_for_log(x);
  chart.is_log_y = lines.empty() && is_for_log(y);
  const auto scale = [](bool is_log, std::vector<double>& values) {
    for (double& value : values) value = is_log ? std::log10(value) : value;
  };
  for (ChartSeries& one : chart.series) {
    scale(chart.is_log_x, one.values.times_s);
    for (auto* values : {&one.values.values, &one.low, &one.high}) scale(chart.is_log_y, *values);
  }
  for (auto& [place, label] : chart.x_labels) place = chart.is_log_x ? std::log10(place) : place;
  return chart;
}

std::string PageChart::axis_title() const {
  if (series.empty()) return title;
  const std::string& unit = series.front().unit;
  const bool is_common = std::all_of(series.begin(), series.end(),
                                     [&](const ChartSeries& s) { return s.unit == unit; });
  return is_common && !unit.empty() && unit != "1" ? fmt::format("{} [{}]", title, unit) : title;
}

std::string PageChart::alternative_text() const {
  std::string text =
      fmt::format("Chart of {} over {}", axis_title(), x_title.empty() ? "time" : x_title);
  for (const ChartSeries& one : series) {
    const auto [low, high] = range_of(one.values.values);
    text += "; " + one.label;
    if (std::isnan(low)) continue;
    text += fmt::format(" from {:.3g} to {:.3g}", low, high);
    if (!one.unit.empty() && one.unit != "1") text += " " + one.unit;
  }
  return text;
}

PageData PageChart::json() const {
  constexpr double kMicrosecond = 1e-6, kSteps = 1e5;
  const bool is_over_time = x_title.empty();
  std::vector<std::optional<LineStyle>> preferred;
  for (const ChartSeries& one : series) preferred.push_back(one.style);
  const std::vector<LineStyle> distinct = distinct_styles(preferred);
  std::vector<double> all_x;
  for (const ChartSeries& one : series) {
    all_x.insert(all_x.end(), one.values.times_s.begin(), one.values.times_s.end());
  }
  // All series have one unit of x, so that equal ones stay equal.
  const auto [x_first, x_unit] =
      is_over_time ? std::pair(0.0, kMicrosecond) : packing(all_x, 10.0 * kSteps);
  auto list = PageData::array();
  for (std::size_t i = 0; i < series.size(); ++i) {
    const ChartSeries& one = series[i];
    const Series thin = one.marks.empty() ? thinned(one.values, window) : one.values;
    std::vector<double> all = thin.values;
    for (const auto* edge : {&one.low, &one.high})
      all.insert(all.end(), edge->begin(), edge->end());
    const auto [first, unit] = packing(all, kSteps);
    // Over time two series differ in their looks. A mark has the look of its line.
    const LineStyle look = is_over_time ? distinct[i] : one.style.value_or(distinct[i]);
    PageData entry = {{"label", one.label},
                      {"unit", one.unit == "1" ? "" : one.unit},
                      {"about", one.description},
                      {"colour", colour_number(look)},
                      {"dash", dash_number(look)},
                      {"off", one.is_off},
                      {"t", differences(thin.times_s, x_first, x_unit)},
                      {"from", first},
                      {"step", unit},
                      {"v", differences(thin.values, first, unit)}};
    if (!one.marks.empty()) {
      entry.update({{"marks", one.marks}, {"line", one.has_line}, {"names", one.names}});
    }
    if (!one.low.empty()) {
      entry["low"] = differences(one.low, first, unit);
      entry["high"] = differences(one.high, first, unit);
    }
    list.push_back(std::move(entry));
  }
  PageData data = {{"title", axis_title()}, {"lines", lines}, {"series", list}};
  if (window) data["window"] = {window->from_s, window->to_s};
  if (!is_over_time) {
    data["x"] = {{"title", x_title}, {"from", x_first}, {"step", x_unit}, {"log", is_log_x}};
    if (!x_labels.empty()) data["x"]["labels"] = x_labels;
    data["log"] = is_log_y;
  }
  return {{"id", id},
          {"group", group},
          {"axis", axis.empty() ? group : axis},
          {"heading", axis_title() + (is_over_time ? "" : " over " + x_title)},
          {"alt", alternative_text()},
          {"over", is_over_time ? "t [s]" : ""},
          {"data", data}};
}

std::pair<double, double> range_of(const std::vector<double>& values) {
  double low = std::nan(""), high = low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::fmin(low, value);
    high = std::fmax(high, value);
  }
  return {low, high};
}

}  // namespace breakwater
