#include <breakwater/pages/svg_plot.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace breakwater {
namespace {

std::string points_path(const std::vector<PlotPoint>& points, char first) {
  std::string path;
  for (const auto& [x, y] : points) {
    path += fmt::format("{}{} {}", path.empty() ? first : 'L', px(x), px(y));
  }
  return path;
}

// The stretches of finite points.
std::vector<std::vector<PlotPoint>> stretches(const std::vector<PlotPoint>& points) {
  std::vector<std::vector<PlotPoint>> all(1);
  for (const PlotPoint& point : points) {
    if (std::isfinite(point.first) && std::isfinite(point.second)) {
      all.back().push_back(point);
    } else if (!all.back().empty()) {
      all.emplace_back();
    }
  }
  return all;
}

}  // namespace

std::string xml_text(const std::string& text) {
  constexpr std::array<const char*, 5> kSafe = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
  std::string safe;
  for (const char c : text) {
    const std::size_t special = std::string_view("&<>\"'").find(c);
    if (special < kSafe.size()) {
      safe += kSafe[special];
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string px(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

std::string shortened(const std::string& text, std::size_t most) {
  std::size_t letters = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins_letter = (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U;
    if (begins_letter && ++letters > most - 1 && i + 1 < text.size()) {
      return text.substr(0, i) + "…";
    }
  }
  return text;
}

std::string cross_path(double x, double y, double half) {
  return fmt::format("M{} {}l{} {}m0 {}l{} {}", px(x - half), px(y - half), px(2.0 * half),
                     px(2.0 * half), px(-2.0 * half), px(-2.0 * half), px(2.0 * half));
}

std::string spot_path(double x, double y, Identity identity) {
  constexpr std::array<const char*, 3> kShapes = {"m-3 0a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z",
                                                  "m0 -4l4 4l-4 4l-4 -4z", "m-3 -3h6v6h-6z"};
  return fmt::format("M{} {}{}", px(x), px(y),
                     kShapes[static_cast<std::size_t>(dash_number(identity)) % kShapes.size()]);
}

std::string line_path(const std::vector<PlotPoint>& points) {
  std::string path;
  for (const auto& stretch : stretches(points)) path += points_path(stretch, 'M');
  return path;
}

std::string band_path(const std::vector<PlotPoint>& upper, const std::vector<PlotPoint>& lower) {
  // A gap in one edge is a gap in both.
  std::vector<PlotPoint> upper_shown = upper;
  std::vector<PlotPoint> lower_shown = lower;
  for (std::size_t i = 0; i < upper.size(); ++i) {
    if (std::isfinite(upper[i].second) && std::isfinite(lower[i].second)) continue;
    upper_shown[i].second = lower_shown[i].second = std::numeric_limits<double>::quiet_NaN();
  }
  const auto above = stretches(upper_shown);
  auto below = stretches(lower_shown);
  std::string path;
  for (std::size_t i = 0; i < above.size(); ++i) {
    if (above[i].size() < 2) continue;
    std::reverse(below[i].begin(), below[i].end());
    path += points_path(above[i], 'M') + points_path(below[i], 'L') + "Z";
  }
  return path;
}

std::string svg_text(double x, double y, const char* anchor, const std::string& text,
                     const std::string& name) {
  return fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\"{}>{}</text>", px(x), px(y), anchor,
                     name.empty() ? "" : " class=\"" + name + "\"", xml_text(text));
}

std::string svg_dot(double x, double y) {
  return fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"3\"/>", px(x), px(y));
}

PlotRange::PlotRange() : low(std::numeric_limits<double>::infinity()), high(-low) {}

void PlotRange::add(double value) {
  if (!std::isfinite(value)) return;
  low = std::min(low, value);
  high = std::max(high, value);
}

SvgPlot::SvgPlot(const std::string& kind, double width, double height, const std::string& about,
                 const std::string& more)
    : width_(width), height_(height) {
  svg_ = fmt::format("<svg class=\"{}\" viewBox=\"0 0 {} {}\" {}{}>", kind, px(width), px(height),
                     about.empty() ? "aria-hidden=\"true\""
                                   : fmt::format("role=\"img\" aria-label=\"{}\"", xml_text(about)),
                     more);
}

void SvgPlot::path(const std::string& name, const std::string& path, const std::string& more) {
  if (!path.empty()) svg_ += fmt::format("<path class=\"{}\" d=\"{}\"{}/>", name, path, more);
}

void SvgPlot::frame(const PlotArea& area) {
  path("axis",
       fmt::format("M{} {}V{}H{}", px(area.left), px(area.top), px(area.bottom), px(area.right)));
}

void SvgPlot::y_grid(const PlotArea& area, const ChartScale& y, int count) {
  constexpr std::size_t kFewest = 4;
  std::vector<ChartScale::Tick> ticks = y.ticks(count);
  if (ticks.size() < kFewest) ticks = y.ticks(2 * count);
  for (const ChartScale::Tick& tick : ticks) {
    const double at = y(tick.value);
    path("grid", fmt::format("M{} {}H{}", px(area.left), px(at), px(area.right)));
    text(area.left - 5.0, at + 3.5, "end", tick.label);
  }
}

void SvgPlot::x_grid(const PlotArea& area, const ChartScale& x, int count) {
  for (const ChartScale::Tick& tick : x.ticks(count)) {
    path("grid", fmt::format("M{} {}V{}", px(x(tick.value)), px(area.top), px(area.bottom)));
  }
}

void SvgPlot::x_ticks(const PlotArea& area, const ChartScale& x, int count) {
  std::vector<double> places;
  std::vector<std::string> texts;
  for (const ChartScale::Tick& tick : x.ticks(count)) {
    places.push_back(x(tick.value));
    texts.push_back(tick.label);
  }
  x_ticks(area, places, texts);
}

void SvgPlot::x_ticks(const PlotArea& area, const std::vector<double>& places,
                      const std::vector<std::string>& texts) {
  constexpr std::size_t kMostLetters = 14;
  for (const double place : places) {
    path("tick", fmt::format("M{} {}v4", px(place), px(area.bottom)));
  }
  texts_below(area.bottom + 15.0, places, texts, kMostLetters);
}

void SvgPlot::texts_below(double y, const std::vector<double>& places,
                          const std::vector<std::string>& texts, std::size_t most) {
  double free_from = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string words = shortened(texts[i], most);
    const double half = 0.5 * kLetterWidth * static_cast<double>(words.size());
    const double x = std::clamp(places[i], half, std::max(half, width_ - half));
    if (x - half < free_from) continue;
    text(x, y, "middle", words);
    free_from = x + half + 4.0;
  }
}

void SvgPlot::x_title(const PlotArea& area, const std::string& title) {
  text(0.5 * (area.left + area.right), height_ - 5.0, "middle", shortened(title, 50), "title");
}

void SvgPlot::y_title(const PlotArea& area, const std::string& title) {
  svg_ += fmt::format(
      "<text class=\"title\" text-anchor=\"middle\" transform=\"translate(12 {}) "
      "rotate(-90)\">{}</text>",
      px(0.5 * (area.top + area.bottom)), xml_text(title));
}

}  // namespace breakwater
