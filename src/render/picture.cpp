#include <breakwater/render/picture.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace breakwater {
namespace {

// Smaller steps of luminance are no edges; FXAA uses 1/16.
constexpr std::uint8_t kSmallestContrast = 16;
// Steps below this share of the local maximum are no edges either; FXAA uses 1/8.
constexpr int kRelativeContrast = 8;
// How far to follow an edge to each side, in pixels.
constexpr int kReach = 16;
// How strongly to dim single bright or dark pixels.
constexpr float kSubpixel = 0.5F;

// The luminance around one pixel, in the directions along and across the edge.
struct Edge {
  std::ptrdiff_t along;
  std::ptrdiff_t across;  // towards the steeper side
  float middle;           // the luminance halfway across
  float gradient;         // largest change of the halfway luminance along the edge
};

std::uint32_t blend(const std::uint8_t* a, const std::uint8_t* b, float share_of_b) {
  const int weight = static_cast<int>(std::lround(share_of_b * 256.0F));
  std::array<std::uint8_t, 4> mixed{};
  for (std::size_t i = 0; i < 4; ++i) {
    mixed[i] = static_cast<std::uint8_t>((a[i] * (256 - weight) + b[i] * weight + 128) >> 8);
  }
  std::uint32_t colour = 0;
  std::memcpy(&colour, mixed.data(), 4);
  return colour;
}

// The end of an edge, and its difference of luminance from the middle.
struct End {
  int distance;
  float difference;
  bool found;  // false: the picture or the reach ended first
};

End follow(const std::uint8_t* luma, const Edge& edge, std::ptrdiff_t step, int room) {
  End end{0, 0.0F, false};
  const int reach = std::min(room, kReach);
  while (end.distance < reach) {
    luma += step;
    ++end.distance;
    end.difference = 0.5F * static_cast<float>(luma[0] + luma[edge.across]) - edge.middle;
    end.found = std::abs(end.difference) >= edge.gradient;
    if (end.found) break;
  }
  return end;
}

// Returns the share of the neighbour across the edge in the pixel's new colour, and sets `across`.
float share(const std::uint8_t* luma, std::ptrdiff_t width, int x, int y, int height,
            std::ptrdiff_t& across) {
  const std::ptrdiff_t w = width;
  const int c = luma[0];
  const int n = luma[-w];
  const int s = luma[w];
  const int e = luma[1];
  const int o = luma[-1];
  const int ne = luma[1 - w];
  const int nw = luma[-1 - w];
  const int se = luma[1 + w];
  const int sw = luma[-1 + w];

  const int horizontal =
      std::abs(nw - 2 * o + sw) + 2 * std::abs(n - 2 * c + s) + std::abs(ne - 2 * e + se);
  const int vertical =
      std::abs(nw - 2 * n + ne) + 2 * std::abs(o - 2 * c + e) + std::abs(sw - 2 * s + se);
  const bool is_horizontal = horizontal >= vertical;
  const int before = is_horizontal ? n : o;
  const int after = is_horizontal ? s : e;
  const bool steeper_before = std::abs(before - c) >= std::abs(after - c);

  Edge edge{};
  edge.along = is_horizontal ? 1 : w;
  across = (is_horizontal ? w : 1) * (steeper_before ? -1 : 1);
  edge.across = across;
  const int other = steeper_before ? before : after;
  edge.middle = 0.5F * static_cast<float>(c + other);
  edge.gradient = 0.25F * static_cast<float>(std::abs(other - c));

  const int room_before = is_horizontal ? x - 1 : y - 1;
  const int room_after = is_horizontal ? static_cast<int>(width) - 2 - x : height - 2 - y;
  const End back = follow(luma, edge, -edge.along, room_before);
  const End forth = follow(luma, edge, edge.along, room_after);
  const End& nearer = back.distance < forth.distance ? back : forth;

  // The line between the ends covers this pixel only if the nearer end turns the other way.
  float along_edge = 0.0F;
  const bool below_middle = static_cast<float>(c) < edge.middle;
  if (nearer.found && (nearer.difference < 0.0F) != below_middle) {
    along_edge = 0.5F - static_cast<float>(nearer.distance) /
                            static_cast<float>(back.distance + forth.distance);
  }

  const int highest = std::max({c, n, s, e, o});
  const int lowest = std::min({c, n, s, e, o});
  const float average = static_cast<float>(2 * (n + s + e + o) + ne + nw + se + sw) / 12.0F;
  const float stands_out = std::clamp(
      std::abs(average - static_cast<float>(c)) / static_cast<float>(highest - lowest), 0.0F, 1.0F);
  const float smooth = (3.0F - 2.0F * stands_out) * stands_out * stands_out;
  return std::max(along_edge, smooth * smooth * kSubpixel);
}

// The compiler can vectorise the two loops over all pixels.

// Rec. 601 in integers of 1/256.
void take_luma(const std::uint8_t* __restrict pixels, std::uint8_t* __restrict luma,
               std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t p = 0;
    std::memcpy(&p, pixels + 4 * i, sizeof(p));
    const std::uint32_t blue = p & 255U;
    const std::uint32_t green = (p >> 8U) & 255U;
    const std::uint32_t red = (p >> 16U) & 255U;
    luma[i] = static_cast<std::uint8_t>((29U * blue + 150U * green + 77U * red) >> 8U);
  }
}

// Marks the pixels of a row that differ enough from a neighbour, except the first and the last.
void find_contrast(const std::uint8_t* __restrict row, const std::uint8_t* __restrict above,
                   const std::uint8_t* __restrict below, std::uint8_t* __restrict contrast,
                   std::size_t width) {
  const auto max = [](std::uint8_t a, std::uint8_t b) { return a > b ? a : b; };
  const auto min = [](std::uint8_t a, std::uint8_t b) { return a < b ? a : b; };
  for (std::size_t x = 1; x + 1 < width; ++x) {
    const std::uint8_t high =
        max(max(max(above[x], below[x]), max(row[x - 1], row[x + 1])), row[x]);
    const std::uint8_t low = min(min(min(above[x], below[x]), min(row[x - 1], row[x + 1])), row[x]);
    const auto range = static_cast<std::uint8_t>(high - low);
    const std::uint8_t least =
        max(kSmallestContrast, static_cast<std::uint8_t>(high / kRelativeContrast));
    contrast[x] = range >= least ? 1 : 0;
  }
}

constexpr Colour kInk{0.10, 0.12, 0.15, 1.0};
constexpr Colour kBox{1.0, 1.0, 1.0, 0.82};
constexpr Colour kGap{0.25, 0.27, 0.30, 1.0};
constexpr double kMargin = 14.0;  // distance of boxes from the border, in units
// Background above and below the scene: blue, green, red.
constexpr std::array<double, 3> kTop = {224.0, 212.0, 200.0};
constexpr std::array<double, 3> kBottom = {246.0, 243.0, 240.0};
// An arrow shorter than this has no number: it would be unreadably small.
constexpr double kShortestArrow_m = 0.004;

std::string speed_text(double speed) {
  if (std::abs(speed - 1.0) < 1e-9) return "";
  return speed < 1.0 ? fmt::format("{:.3g}\u00d7 slower", 1.0 / speed)
                     : fmt::format("{:.3g}\u00d7 faster", speed);
}

// The place of a number of half size `half` beyond an arrow's tip, within the panel.
Point place_beyond(const Point& from, const Point& to, const Point& half, const Point& panel) {
  const double length = std::max(std::hypot(to.x - from.x, to.y - from.y), 1.0);
  const Point along{(to.x - from.x) / length, (to.y - from.y) / length};
  const double reach = std::abs(along.x) * half.x + std::abs(along.y) * half.y + 0.5 * half.y;
  return {std::clamp(to.x + reach * along.x, half.x, panel.x - half.x),
          std::clamp(to.y + reach * along.y, half.y, panel.y - half.y)};
}

}  // namespace

void smooth_edges(std::vector<std::uint8_t>& pixels, int width, int height) {
  const auto w = static_cast<std::ptrdiff_t>(width);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<std::uint8_t> luma(count), contrast(static_cast<std::size_t>(width), 0);
  std::vector<std::pair<std::size_t, std::uint32_t>> smoothed;  // pixels and their new colours
  take_luma(pixels.data(), luma.data(), count);

  for (int y = 1; y + 1 < height; ++y) {
    const std::uint8_t* const row = luma.data() + y * w;
    find_contrast(row, row - w, row + w, contrast.data(), static_cast<std::size_t>(width));
    for (int x = 1; x + 1 < width; ++x) {
      if (contrast[static_cast<std::size_t>(x)] == 0) continue;
      std::ptrdiff_t across = 0;
      const float part = share(row + x, w, x, y, height, across);
      if (part <= 0.0F) continue;
      const std::ptrdiff_t pixel = y * w + x;
      smoothed.emplace_back(static_cast<std::size_t>(pixel),
                            blend(&pixels[static_cast<std::size_t>(4 * pixel)],
                                  &pixels[static_cast<std::size_t>(4 * (pixel + across))], part));
    }
  }
  for (const auto& [pixel, colour] : smoothed) std::memcpy(&pixels[4 * pixel], &colour, 4);
}

double Picture::unit_px(double width, double height) {
  const double fits = std::min(width / 900.0, height / 720.0);
  return fits >= 0.85 ? fits : std::max(fits, std::min(0.85, width / 380.0));
}

SceneArrow arrow_at(const ArrowTrack& track, double time_s) {
  Eigen::Vector3d value = Eigen::Vector3d::Constant(track.components.front().at(time_s).value);
  if (track.components.size() == 3) {
    for (int k = 0; k < 3; ++k) {
      value[k] = track.components[static_cast<std::size_t>(k)].at(time_s).value;
    }
  }
  const Eigen::Vector3d force = value.cwiseProduct(track.along);
  SceneArrow now = track.arrow;
  now.number = force.norm();
  now.vector_m = track.metres_per_unit * force;
  if (force.isZero(0.0)) now.contact_mark_m = 0.0;
  return now;
}

void interpolate_qpos(const PictureRun& run, double time_s, std::vector<double>& qpos) {
  const std::vector<double>& times = run.times_s;
  const double time = std::clamp(time_s, times.front(), times.back());
  const auto after = std::upper_bound(times.begin(), times.end() - 1, time);
  const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - times.begin(), 1));
  const double part = (time - times[i - 1]) / (times[i] - times[i - 1]);
  const mjModel* const model = run.model.get();
  const double* const before = run.qpos.row(i - 1);
  qpos.assign(before, before + run.qpos.width);
  std::vector<double> way(static_cast<std::size_t>(model->nv));
  mj_differentiatePos(model, way.data(), 1.0, before, run.qpos.row(i));
  mj_integratePos(model, qpos.data(), way.data(), part);
}

Picture::Picture(std::vector<PictureRun>& runs, const PictureStyle& style)
    : runs_(runs),
      style_(style),
      offscreen_(style.width * style.look.samples, style.height * style.look.samples),
      panels_(runs.size()) {
  const auto samples = static_cast<std::size_t>(style_.look.samples);
  if (samples > 1) pixels_.resize(offscreen_.pixels().size() / (samples * samples));
  lay_out();
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    Panel& panel = panels_[i];
    panel.view =
        std::make_unique<SceneView>(offscreen_, runs_[i].model, runs_[i].camera, style_.look);
    if (panel.chart_area.width > 0.0) {
      panel.chart = std::make_unique<Chart>(style_.chart_title, runs_[i].lines, style_.chart_range,
                                            static_cast<int>(panel.chart_area.width),
                                            static_cast<int>(panel.chart_area.height),
                                            unit_px(panel.area.width, style_.height));
    }
  }
}

// One to three runs are in a row, four in a square. The chart of a wide picture is in a corner,
// that of a narrow one below the picture.
void Picture::lay_out() {
  const std::size_t count = panels_.size();
  const std::size_t columns = count == 4 ? 2 : count;
  const std::size_t rows = count == 4 ? 2 : 1;
  const auto edge = [](int size, std::size_t part, std::size_t parts) {
    return std::round(static_cast<double>(size) * static_cast<double>(part) /
                      static_cast<double>(parts));
  };
  for (std::size_t i = 0; i < count; ++i) {
    Panel& panel = panels_[i];
    const std::size_t column = i % columns;
    const std::size_t row = i / columns;
    panel.area.left = edge(style_.width, column, columns);
    panel.area.top = edge(style_.height, row, rows);
    panel.area.width = edge(style_.width, column + 1, columns) - panel.area.left;
    panel.area.height = edge(style_.height, row + 1, rows) - panel.area.top;
    if (runs_[i].lines.empty()) continue;
    Rectangle& chart = panel.chart_area;
    if (panel.area.width < panel.area.height) {
      chart = panel.area;
      chart.height = std::round(std::min(0.38 * panel.area.height, 0.62 * panel.area.width));
      chart.top = panel.area.bottom() - chart.height;
      panel.area.height -= chart.height;
    } else {
      const double unit = unit_px(panel.area.width, panel.area.height);
      const double margin = std::round(kMargin * unit);
      chart.width = std::round(std::min(460.0 * unit, 0.52 * panel.area.width));
      chart.height = std::round(std::min(220.0 * unit, 0.36 * panel.area.height));
      chart.left = style_.chart_corner.is_right ? panel.area.right() - chart.width - margin
                                                : panel.area.left + margin;
      chart.top = style_.chart_corner.is_bottom ? panel.area.bottom() - chart.height - margin
                                                : panel.area.top + margin;
    }
  }
}

void Picture::draw_scene(PictureRun& run, Panel& panel, double time_s) {
  const double time = std::clamp(time_s, run.times_s.front(), run.times_s.back());
  interpolate_qpos(run, time, qpos_);
  if (run.animate) run.animate(run.model, time);
  for (const WavingSurface& surface : run.surfaces) set_heights(run.model, surface, time);
  panel.view->pose(qpos_);

  panel.arrows.clear();
  for (const ArrowTrack& track : run.arrows) panel.arrows.push_back(arrow_at(track, time));

  const int samples = style_.look.samples;
  const mjrRect viewport = {samples * static_cast<int>(panel.area.left),
                            samples * (style_.height - static_cast<int>(panel.area.bottom())),
                            samples * static_cast<int>(panel.area.width),
                            samples * static_cast<int>(panel.area.height)};
  panel.view->draw(viewport, panel.arrows);
}

// Mesa leaves 0 in the fourth byte where nothing is drawn. A translucent layer of alpha a over the
// empty background leaves a² there, and a times its colour. Add the missing 1 − a of it.
void Picture::fill_background() {
  std::vector<std::uint8_t>& pixels = offscreen_.pixels();
  const auto width = static_cast<std::size_t>(offscreen_.width());
  const auto height = static_cast<std::size_t>(offscreen_.height());
  for (std::size_t y = 0; y < height; ++y) {
    const double part = static_cast<double>(y) / static_cast<double>(height);
    std::array<double, 3> colour{};
    std::array<std::uint8_t, 4> sky = {0, 0, 0, 255};
    for (std::size_t k = 0; k < 3; ++k) {
      colour[k] = kTop[k] + part * (kBottom[k] - kTop[k]);
      sky[k] = static_cast<std::uint8_t>(std::lround(colour[k]));
    }
    for (std::size_t x = 0; x < width; ++x) {
      std::uint8_t* const pixel = pixels.data() + 4 * (width * y + x);
      if (pixel[3] == 255) continue;
      if (pixel[3] == 0) {
        std::memcpy(pixel, sky.data(), sky.size());
        continue;
      }
      const double shows = 1.0 - std::sqrt(pixel[3] / 255.0);
      for (std::size_t k = 0; k < 3; ++k) {
        pixel[k] =
            static_cast<std::uint8_t>(std::lround(std::min(pixel[k] + shows * colour[k], 255.0)));
      }
      pixel[3] = 255;
    }
  }
}

// Averages the samples of each pixel.
void Picture::shrink() {
  const auto samples = static_cast<std::size_t>(style_.look.samples);
  const auto width = static_cast<std::size_t>(style_.width);
  const std::vector<std::uint8_t>& fine = offscreen_.pixels();
  const std::size_t stride = 4 * samples * width;
  for (std::size_t pixel = 0; pixel < pixels_.size() / 4; ++pixel) {
    const std::size_t corner = (pixel / width) * samples * stride + 4 * samples * (pixel % width);
    std::array<std::size_t, 4> sum{};
    for (std::size_t y = 0; y < samples; ++y) {
      for (std::size_t k = 0; k < 4 * samples; ++k) sum[k % 4] += fine[corner + y * stride + k];
    }
    for (std::size_t k = 0; k < 4; ++k) {
      pixels_[4 * pixel + k] =
          static_cast<std::uint8_t>((sum[k] + samples * samples / 2) / (samples * samples));
    }
  }
}

void Picture::draw_arrow_numbers(Canvas& canvas, const PictureRun& run, const Panel& panel) const {
  const double unit = unit_px(panel.area.width, style_.height);
  canvas.clip(panel.area);
  // The view has more samples per pixel than the canvas.
  const double samples = style_.look.samples;
  for (std::size_t i = 0; i < panel.arrows.size(); ++i) {
    const SceneArrow& arrow = panel.arrows[i];
    const double value = arrow.number;
    if (run.arrows[i].unit.empty() || arrow.vector_m.norm() < kShortestArrow_m) continue;
    const auto ends = panel.view->ends_of(arrow);
    if (!ends) continue;
    const int decimals = value < 0.995 ? 2 : value < 99.95 ? 1 : 0;
    const std::string number = fmt::format("{:.{}f} {}", value, decimals, run.arrows[i].unit);
    const double size = 19.0 * unit;
    const Point half{0.5 * canvas.text_width(number, size, true) + 2.0, 0.55 * size};
    if (panel.area.width < 2.0 * half.x || panel.area.height < 2.0 * half.y) continue;
    const auto scaled = [&](const Point& point) {
      return Point{point.x / samples, point.y / samples};
    };
    const Point at = place_beyond(scaled(ends->from), scaled(ends->to), half,
                                  {panel.area.width, panel.area.height});
    canvas.text({panel.area.left + at.x, panel.area.top + at.y + 0.36 * size}, number, size,
                arrow.colour, Align::center, true, true);
  }
  canvas.unclip();
}

void Picture::draw_caption(Canvas& canvas, const PictureRun& run, const Panel& panel,
                           double time_s) const {
  const double unit = unit_px(panel.area.width, style_.height);
  const double margin = std::round(kMargin * unit);
  const double size = 20.0 * unit;
  // Next to the chart, if that is at the top too.
  double left = panel.area.left + margin;
  double right = panel.area.right() - margin;
  const Rectangle& chart = panel.chart_area;
  if (chart.width > 0.0 && chart.top < panel.area.top + margin + 3.1 * size) {
    if (style_.chart_corner.is_right)
      right = chart.left - margin;
    else
      left = chart.right() + margin;
  }
  // Shrink a long text, so that it fits.
  const double room = right - left - 1.4 * size;
  const auto fitted = [&](const std::string& text, double wished, bool is_bold) {
    return wished * std::min(1.0, room / std::max(canvas.text_width(text, wished, is_bold), 1.0));
  };
  const std::string time = fmt::format("t = {:.{}f} s", time_s, style_.time_decimals);
  const std::string speed = speed_text(style_.speed);
  const std::string second = speed.empty() ? time : time + "   " + speed;
  const double first = fitted(run.caption, size, true);
  const double small = fitted(second, 17.0 * unit, false);
  // Digits have equal widths, so the box does not move.
  const double width =
      std::max(canvas.text_width(run.caption, first, true), canvas.text_width(second, small));
  canvas.clip(panel.area);
  canvas.fill({left, panel.area.top + margin, width + 1.4 * size, 3.1 * size}, kBox, 0.4 * size);
  const double x = left + 0.7 * size;
  canvas.text({x, panel.area.top + margin + 1.25 * size}, run.caption, first, kInk, Align::left,
              true);
  canvas.text({x, panel.area.top + margin + 2.5 * size}, second, small, kInk);
  canvas.unclip();
}

const std::uint8_t* Picture::draw(double time_s) {
  for (std::size_t i = 0; i < runs_.size(); ++i) draw_scene(runs_[i], panels_[i], time_s);
  offscreen_.finish();
  fill_background();
  std::vector<std::uint8_t>* pixels = &offscreen_.pixels();
  if (style_.look.samples > 1) {
    shrink();
    pixels = &pixels_;
  } else {
    smooth_edges(*pixels, style_.width, style_.height);
  }

  Canvas canvas(pixels->data(), style_.width, style_.height);
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    Panel& panel = panels_[i];
    draw_arrow_numbers(canvas, runs_[i], panel);
    if (style_.captions) draw_caption(canvas, runs_[i], panel, time_s);
    if (panel.chart) {
      const Rectangle& area = panel.chart_area;
      panel.chart->draw(canvas, static_cast<int>(area.left), static_cast<int>(area.top), time_s);
    }
    if (panel.area.left > 0.0) {
      canvas.fill({panel.area.left - 1.0, panel.area.top, 2.0,
                   std::max(panel.area.height, panel.chart_area.bottom() - panel.area.top)},
                  kGap);
    }
    if (panel.area.top > 0.0) {
      canvas.fill({panel.area.left, panel.area.top - 1.0, panel.area.width, 2.0}, kGap);
    }
  }
  if (!style_.title.empty() && runs_.size() == 1) {
    const double unit = unit_px(style_.width, style_.height);
    const bool is_left = style_.chart_corner.is_right || !style_.chart_corner.is_bottom;
    const double margin = kMargin * unit;
    canvas.text({is_left ? margin : style_.width - margin, panels_.front().area.bottom() - margin},
                style_.title, 17.0 * unit, kInk, is_left ? Align::left : Align::right, false, true);
  }
  return pixels->data();
}

}  // namespace breakwater
