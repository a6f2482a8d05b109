#include <breakwater/render/chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

void add_sample(Series& to, const Series& from, std::size_t i) {
  to.times_s.push_back(from.times_s[i]);
  to.values.push_back(from.values[i]);
}

// Drops the samples that equal both their neighbours.
Series without_repetition(const Series& series) {
  Series kept;
  const std::vector<double>& v = series.values;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const bool is_inside = i > 0 && i + 1 < v.size();
    if (!is_inside || v[i] != v[i - 1] || v[i] != v[i + 1]) add_sample(kept, series, i);
  }
  return kept;
}

}  // namespace

Series cut(const Series& series, double from_s, double to_s) {
  Series part;
  for (std::size_t i = 0; i < series.times_s.size(); ++i) {
    if (series.times_s[i] >= from_s && series.times_s[i] <= to_s) add_sample(part, series, i);
  }
  return part;
}

Series decimate(const Series& series, std::size_t buckets) {
  const std::size_t size = series.values.size();
  if (size <= 2 * buckets) return without_repetition(series);
  Series kept;
  add_sample(kept, series, 0);
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    const auto begin = series.values.begin() + static_cast<std::ptrdiff_t>(bucket * size / buckets);
    const auto end =
        series.values.begin() + static_cast<std::ptrdiff_t>((bucket + 1) * size / buckets);
    // A value that is not finite is a gap, not an extreme.
    const auto finite = std::find_if(begin, end, [](double v) { return std::isfinite(v); });
    auto smallest = finite;
    auto largest = finite;
    for (auto v = finite; v != end; ++v) {
      if (*v < *smallest) smallest = v;
      if (*v > *largest) largest = v;
    }
    if (finite == end) smallest = largest = begin;
    for (const auto& extreme : {std::min(smallest, largest), std::max(smallest, largest)}) {
      const auto i = static_cast<std::size_t>(extreme - series.values.begin());
      if (series.times_s[i] > kept.times_s.back()) add_sample(kept, series, i);
    }
  }
  if (kept.times_s.back() < series.times_s.back()) add_sample(kept, series, size - 1);
  return without_repetition(kept);
}

ChartRange chart_range(const std::vector<ChartLine>& lines, double from_s, double to_s) {
  ChartRange range{from_s, to_s, 0.0, 0.0};
  for (const ChartLine& line : lines) {
    const auto include = [&range](double value) {
      range.lowest = std::min(range.lowest, value);
      range.highest = std::max(range.highest, value);
    };
    for (const double value : cut(line.series, from_s, to_s).values) include(value);
    for (const double end_s : {from_s, to_s}) include(line.series.at(end_s).value);
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
  for (const ChartLine& line : lines_) {
    const Series inside = cut(line.series, range.from_s, range.to_s);
    drawn_.push_back(decimate(inside, static_cast<std::size_t>(width)));
  }
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

void Chart::draw(Canvas& canvas, int left, int top, double now_s) {
  canvas.paste(*frame_, left, top);
  const double now = std::clamp(now_s, range_.from_s, range_.to_s);
  const auto shift = [&](Point p) { return Point{p.x + left, p.y + top}; };
  const double y_zero = std::clamp(0.0, range_.lowest, range_.highest);
  canvas.line({shift(place(range_.from_s, y_zero)), shift(place(range_.to_s, y_zero))}, kMark, 1.0);
  for (std::size_t i = lines_.size(); i-- > 0;) {  // draw the first line last, on top
    const Series& series = lines_[i].series;
    std::vector<Point> points;
    const auto add = [&](double time_s, double value) {
      points.push_back(shift(place(time_s, value)));
    };
    add(range_.from_s, series.at(range_.from_s).value);
    const Series past = cut(drawn_[i], range_.from_s, now);
    for (std::size_t k = 0; k < past.values.size(); ++k) add(past.times_s[k], past.values[k]);
    add(now, series.at(now).value);
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
