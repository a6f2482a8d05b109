#include <breakwater/render/chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace breakwater {
namespace {

constexpr Colour kPaper{1.0, 1.0, 1.0, 1.0};
constexpr Colour kChartInk{0.13, 0.15, 0.18, 1.0};
constexpr Colour kGrid{0.88, 0.89, 0.90, 1.0};
constexpr Colour kMark{0.45, 0.47, 0.50, 1.0};
constexpr double kTextUnits = 15.0;
constexpr double kLegendGap = 2.4;  // between its entries, in text sizes

std::vector<double> strokes(LineStyle style, double unit_px) {
  std::vector<double> lengths = dashes(style);
  for (double& length : lengths) length *= unit_px;
  return lengths;
}

// The smallest step of 1, 2 or 5 times a power of ten that divides `span` into at most `parts`.
double nice_step(double span, double parts) {
  const double raw = span / parts;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

std::vector<double> ticks(double from, double to, double parts) {
  const double step = nice_step(to - from, parts);
  std::vector<double> values;
  const auto first = std::llround(std::ceil(from / step - 1e-6));
  const auto last = std::llround(std::floor(to / step + 1e-6));
  for (auto k = first; k <= last; ++k) values.push_back(static_cast<double>(k) * step);
  return values;
}

// As many decimals as the distance between ticks requires.
std::string tick_text(double value, const std::vector<double>& all) {
  const double step = all.size() > 1 ? all[1] - all[0] : 1.0;
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  if (std::abs(value) < 1e-9 * step) value = 0.0;
  return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

ChartRange chart_range(const std::vector<ChartLine>& lines, double from_s, double to_s) {
  ChartRange range{from_s, to_s, 0.0, 0.0};
  for (const ChartLine& line : lines) {
    const auto include = [&range](double value) {
      range.lowest = std::min(range.lowest, value);
      range.highest = std::max(range.highest, value);
    };
    const Series& series = line.series;
    for (std::size_t i = 0; i < series.values.size(); ++i) {
      if (series.times_s[i] >= from_s && series.times_s[i] <= to_s) include(series.values[i]);
    }
    include(series.at(from_s).value);
    include(series.at(to_s).value);
  }
  const double span = range.highest - range.lowest;
  const double room = span > 0.0 ? 0.08 * span : 1.0;
  range.highest += room;
  if (range.lowest < 0.0 || span == 0.0) range.lowest -= room;
  return range;
}

Chart::Chart(const std::string& title, std::vector<ChartLine> lines, const ChartRange& range,
             int width, int height, double unit_px)
    : lines_(std::move(lines)),
      range_(range),
      unit_px_(unit_px),
      frame_(std::make_unique<Canvas>(width, height)) {
  draw_frame(title);
}

Point Chart::place(double time_s, double value) const {
  return {
      plot_.left + plot_.width * (time_s - range_.from_s) / (range_.to_s - range_.from_s),
      plot_.bottom() - plot_.height * (value - range_.lowest) / (range_.highest - range_.lowest)};
}

void Chart::draw_frame(const std::string& title) {
  Canvas& canvas = *frame_;
  const double size = kTextUnits * unit_px_;
  const double width = canvas.width();
  const double height = canvas.height();
  const std::vector<double> levels =
      ticks(range_.lowest, range_.highest, std::max(2.0, height / (3.2 * size)));
  const std::vector<double> instants =
      ticks(range_.from_s, range_.to_s, std::max(2.0, width / (6.0 * size)));

  double label_width = 0.0;
  for (const double v : levels) {
    label_width = std::max(label_width, canvas.text_width(tick_text(v, levels), size));
  }
  plot_ = {label_width + 1.2 * size, 2.1 * size, 0.0, 0.0};
  plot_.width = width - plot_.left - 1.4 * size;
  // The legend is beside the title if there is room, and otherwise below it.
  double legend_line = 1.45 * size;
  const double legend = legend_width(size);
  if (legend > 0.0 && canvas.text_width(title, size, true) + legend > plot_.width) {
    legend_line += 1.35 * size;
    plot_.top += 1.35 * size;
  }
  plot_.height = height - plot_.top - 2.0 * size;

  canvas.fill({0.0, 0.0, width, height}, kPaper);
  canvas.text({plot_.left, 1.45 * size}, title, size, kChartInk, Align::left, true);
  for (const double v : levels) {
    const double y = std::round(place(range_.from_s, v).y) + 0.5;
    canvas.line({{plot_.left, y}, {plot_.right(), y}}, kGrid, 1.0);
    canvas.text({plot_.left - 0.4 * size, y + 0.36 * size}, tick_text(v, levels), size, kChartInk,
                Align::right);
  }
  for (const double t : instants) {
    const double x = std::round(place(t, 0.0).x) + 0.5;
    canvas.line({{x, plot_.top}, {x, plot_.bottom()}}, kGrid, 1.0);
    const double half = 0.5 * canvas.text_width(tick_text(t, instants) + " s", size);
    canvas.text({std::min(x, width - half - 0.4 * size), plot_.bottom() + 1.3 * size},
                tick_text(t, instants) + (t == instants.back() ? " s" : ""), size, kChartInk,
                Align::center);
  }

  draw_legend(legend_line);
}

double Chart::legend_width(double size) const {
  double width = 0.0;
  for (const ChartLine& line : lines_) {
    if (!line.label.empty()) width += frame_->text_width(line.label, size) + kLegendGap * size;
  }
  return width;
}

void Chart::draw_legend(double baseline) {
  const double size = kTextUnits * unit_px_;
  double x = plot_.right();
  for (std::size_t i = lines_.size(); i-- > 0;) {
    if (lines_[i].label.empty()) continue;
    const double text = frame_->text_width(lines_[i].label, size);
    frame_->text({x, baseline}, lines_[i].label, size, kChartInk, Align::right);
    const double y = std::round(baseline - 0.35 * size) + 0.5;
    frame_->line({{x - text - 1.7 * size, y}, {x - text - 0.4 * size, y}},
                 on_paper(lines_[i].style), 2.4 * unit_px_, strokes(lines_[i].style, unit_px_));
    x -= text + kLegendGap * size;
  }
}

// Keeps the first, lowest, highest and last point in each column of pixels, in their order. The
// picture is the same as with all points.
std::vector<Point> Chart::trace(const ChartLine& line, double now_s) const {
  const std::vector<double>& times = line.series.times_s;
  const std::vector<double>& values = line.series.values;
  const auto index_after = [&](auto bound, double time_s) {
    return static_cast<std::size_t>(bound(times.begin(), times.end(), time_s) - times.begin());
  };
  const auto lower = [](auto begin, auto end, double t) { return std::lower_bound(begin, end, t); };
  const auto upper = [](auto begin, auto end, double t) { return std::upper_bound(begin, end, t); };
  const std::size_t end = index_after(upper, now_s);
  std::vector<Point> points = {place(range_.from_s, line.series.at(range_.from_s).value)};
  for (std::size_t i = index_after(lower, range_.from_s); i < end;) {
    const double column = std::floor(place(times[i], 0.0).x);
    std::array<std::size_t, 4> kept = {i, i, i, i};
    do {
      if (values[i] < values[kept[1]]) kept[1] = i;
      if (values[i] > values[kept[2]]) kept[2] = i;
      kept[3] = i++;
    } while (i < end && std::floor(place(times[i], 0.0).x) == column);
    std::sort(kept.begin(), kept.end());
    const auto* const last = std::unique(kept.begin(), kept.end());
    std::transform(kept.cbegin(), last, std::back_inserter(points),
                   [&](std::size_t k) { return place(times[k], values[k]); });
  }
  points.push_back(place(now_s, line.series.at(now_s).value));
  return points;
}

void Chart::draw(Canvas& canvas, int left, int top, double now_s) {
  canvas.paste(*frame_, left, top);
  const double now = std::clamp(now_s, range_.from_s, range_.to_s);
  const auto shift = [&](Point p) { return Point{p.x + left, p.y + top}; };
  const double y_zero = std::clamp(0.0, range_.lowest, range_.highest);
  canvas.line({shift(place(range_.from_s, y_zero)), shift(place(range_.to_s, y_zero))}, kMark, 1.0);
  for (std::size_t i = lines_.size(); i-- > 0;) {  // draw the first line last, on top
    std::vector<Point> points = trace(lines_[i], now);
    for (Point& p : points) p = shift(p);
    canvas.line(points, on_paper(lines_[i].style), 2.0 * unit_px_,
                strokes(lines_[i].style, unit_px_));
  }
  if (!lines_.empty()) {
    canvas.dot(shift(place(now, lines_.front().series.at(now).value)), 4.5 * unit_px_,
               on_paper(lines_.front().style));
  }
}

void Chart::mark(double time_s, const std::string& caption) {
  const double size = kTextUnits * unit_px_;
  const double x = std::round(place(time_s, 0.0).x) + 0.5;
  frame_->line({{x, plot_.top}, {x, plot_.bottom()}}, kMark, 1.5 * unit_px_,
               {4.0 * unit_px_, 3.0 * unit_px_});
  frame_->text({x + 0.3 * size, plot_.top + 1.1 * size}, caption, size, kChartInk);
}

}  // namespace breakwater
