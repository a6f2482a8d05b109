#include <breakwater/pages/study_charts.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <breakwater/pages/html_page.h>
#include <breakwater/pages/svg_plot.h>

namespace breakwater {
namespace {

constexpr double kWidth = 360.0, kHeight = 250.0;
constexpr double kLeft = 50.0, kRight = 10.0, kTop = 12.0, kBottom = 40.0;
constexpr double kFailureRow = 8.0;  // height of the row of crosses

std::string refs(const std::vector<std::size_t>& runs) {
  return fmt::format("{}", fmt::join(runs, ","));
}

std::size_t heat_level(double share) {
  return std::min(kHeatLevels - 1,
                  static_cast<std::size_t>(share * static_cast<double>(kHeatLevels)));
}

}  // namespace

std::string draw(const LineChart& chart) {
  PlotRange range;
  bool has_failures = false;
  for (const auto& line : chart.lines) {
    for (const LineMark& mark : line) {
      has_failures |= mark.has_failures;
      if (!std::isfinite(mark.y)) continue;
      for (const double value : {mark.y, mark.lower, mark.upper}) range.add(value);
    }
  }
  const bool is_empty = range.is_empty() && !chart.is_share;
  if (chart.is_share || is_empty) range.low = 0.0, range.high = 1.0;
  const double crosses =
      has_failures ? kFailureRow * static_cast<double>(chart.lines.size()) + 4.0 : 0.0;
  const PlotArea area{kLeft, kWidth - kRight, kTop, kHeight - kBottom};
  const double bottom = area.bottom - crosses;
  const ChartScale y(range.low, range.high, is_for_log(range.low, range.high), bottom - 6.0,
                     kTop + 6.0);
  const auto [first, last] = std::minmax_element(chart.x.begin(), chart.x.end());
  const ChartScale x(*first, *last, chart.is_log_x, area.left + 10.0, area.right - 10.0);

  SvgPlot plot("lines", kWidth, kHeight, chart.y_title + " over " + chart.x_title);
  if (!is_empty) plot.y_grid(area, y);
  plot.frame(area);
  if (chart.x_labels.empty()) {
    plot.x_ticks(area, x);
  } else {
    std::vector<double> places;
    for (const double value : chart.x) places.push_back(x(value));
    plot.x_ticks(area, places, chart.x_labels);
  }
  plot.x_title(area, chart.x_title);
  const auto points = [&](const std::vector<LineMark>& marks, double LineMark::*value) {
    std::vector<PlotPoint> all;
    for (const LineMark& mark : marks) all.emplace_back(x(mark.x), y(mark.*value));
    return all;
  };
  for (std::size_t c = 0; c < chart.lines.size() && !chart.is_share; ++c) {
    plot.path("band " + series_class(chart.looks[c]),
              band_path(points(chart.lines[c], &LineMark::upper),
                        points(chart.lines[c], &LineMark::lower)));
  }
  for (std::size_t c = 0; c < chart.lines.size(); ++c) {
    const std::string name = series_class(chart.looks[c]);
    plot.path("line " + name, line_path(points(chart.lines[c], &LineMark::y)));
    plot.add(fmt::format("<g class=\"{}\">", name));
    for (const LineMark& mark : chart.lines[c]) {
      if (!std::isfinite(mark.y) && !mark.has_failures) continue;
      plot.add(fmt::format("<g class=\"m\" data-r=\"{}\"><title>{}</title>", refs(mark.runs),
                           xml_text(mark.text)));
      if (std::isfinite(mark.y)) {
        if (chart.x.size() == 1) {  // the band has no width
          plot.path("line", line_path({{x(mark.x), y(mark.lower)}, {x(mark.x), y(mark.upper)}}));
        }
        plot.add(svg_dot(x(mark.x), y(mark.y)));
      }
      if (mark.has_failures) {
        const double row = bottom + kFailureRow * (static_cast<double>(c) + 0.5) + 2.0;
        plot.path("x", cross_path(x(mark.x), row, 3.0));
      }
      plot.add("</g>");
    }
    plot.add("</g>");
  }
  if (is_empty) plot.text(0.5 * (kLeft + kWidth), 0.5 * kHeight, "middle", "no run has it");
  return plot.svg();
}

std::string draw(const HeatMap& map) {
  constexpr std::size_t kLongestRow = 20;  // letters
  const auto columns = map.x_labels.size(), rows = map.y_labels.size();
  std::size_t longest = 0;
  for (const std::string& text : map.y_labels) longest = std::max(longest, text.size());
  // Left of the cells there is room for the rows' labels.
  const double labels =
      std::max(66.0, 8.0 + kLetterWidth * static_cast<double>(std::min(longest, kLongestRow)));
  const double width = (kWidth - labels - kRight) / static_cast<double>(columns);
  const double height = std::clamp(220.0 / static_cast<double>(rows), 6.0, 34.0);
  const double bottom = kTop + height * static_cast<double>(rows);
  const ChartScale colour(map.low, map.high, is_for_log(map.low, map.high), 0.0, 1.0);

  std::vector<std::string> levels(kHeatLevels);
  std::string dead, some, absent, texts, values, counts, runs;
  const bool has_numbers = columns <= 8 && rows <= 14 && width > 30.0 && height > 13.0;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const HeatCell& cell = map.cells[row * columns + column];
      const double x = labels + width * static_cast<double>(column);
      const double y = bottom - height * static_cast<double>(row + 1);
      const std::string box =
          fmt::format("M{} {}h{}v{}h{}z", px(x), px(y), px(width), px(height), px(-width));
      if (std::isfinite(cell.value)) {
        const std::size_t level = heat_level(colour.share(cell.value));
        levels[level] += box;
        if (cell.measured + cell.failed < cell.runs) {
          absent +=
              fmt::format("M{} {}h{}", px(x + 0.35 * width), px(y + height - 2.5), px(0.3 * width));
        }
        if (has_numbers) {
          texts +=
              svg_text(x + 0.5 * width, y + 0.5 * height + 3.5, "middle", format_number(cell.value),
                       level < kHeatLevels * 6 / 10 ? "on dark" : "on");
        }
      } else if (cell.runs > 0 && cell.failed < cell.runs) {
        absent +=
            fmt::format("M{} {}h{}", px(x + 0.35 * width), px(y + 0.5 * height), px(0.3 * width));
      }
      const double half = 0.3 * std::min(width, height);
      if (cell.runs > 0 && cell.failed == cell.runs) {
        dead += cross_path(x + 0.5 * width, y + 0.5 * height, half);
      } else if (cell.failed > 0) {
        some += fmt::format("M{} {}h{}v{}z", px(x + width - half - 1.0), px(y + 1.0), px(half),
                            px(half));
      }
      const bool is_first = row == 0 && column == 0;
      values += (is_first ? "" : " ") +
                (std::isfinite(cell.value) ? fmt::format("{:.3g}", cell.value) : "-");
      counts += fmt::format("{}{}/{}", is_first ? "" : " ", cell.failed, cell.runs);
      runs += (is_first ? "" : " ") + (cell.run ? std::to_string(*cell.run) : "-");
    }
  }

  SvgPlot plot("heat", kWidth, bottom + kBottom, map.about,
               fmt::format(" tabindex=\"0\" data-grid=\"{} {} {:.4f} {:.4f} {} {}\" data-x=\"{}\" "
                           "data-y=\"{}\" data-x-title=\"{}\" data-y-title=\"{}\" data-v=\"{}\" "
                           "data-n=\"{}\" data-r=\"{}\"",
                           px(labels), px(bottom), width, height, columns, rows,
                           xml_text(fmt::format("{}", fmt::join(map.x_labels, "\n"))),
                           xml_text(fmt::format("{}", fmt::join(map.y_labels, "\n"))),
                           xml_text(map.x_title), xml_text(map.y_title), values, counts, runs));
  for (std::size_t level = 0; level < kHeatLevels; ++level) {
    plot.path(fmt::format("h{}", level), levels[level]);
  }
  plot.path("frame", fmt::format("M{} {}H{}V{}H{}z", px(labels), px(kTop), px(kWidth - kRight),
                                 px(bottom), px(labels)));
  plot.add(texts);
  plot.path("absent", absent);
  plot.path("dead", dead);
  plot.path("some", some);
  std::vector<double> middles;
  for (std::size_t column = 0; column < columns; ++column) {
    middles.push_back(labels + width * (static_cast<double>(column) + 0.5));
  }
  plot.texts_below(bottom + 14.0, middles, map.x_labels,
                   std::max<std::size_t>(14, static_cast<std::size_t>(width / kLetterWidth)));
  double free_above = bottom + 20.0;
  for (std::size_t row = 0; row < rows; ++row) {
    const double y = bottom - height * (static_cast<double>(row) + 0.5) + 3.5;
    if (y > free_above) continue;
    plot.text(labels - 5.0, y, "end", shortened(map.y_labels[row], kLongestRow));
    free_above = y - 13.0;
  }
  plot.x_title({labels, kWidth - kRight, kTop, bottom}, map.x_title);
  plot.text(2.0, kTop - 3.0, "start", shortened(map.y_title, 52), "title");
  plot.add("<path class=\"at\" d=\"\"/>");
  return plot.svg();
}

std::string draw_colour_bar(double low, double high) {
  constexpr double kBar = 14.0;
  const ChartScale scale(low, high, is_for_log(low, high), 12.0, kWidth - 24.0);
  SvgPlot plot("bar", kWidth, 36.0,
               "colours from " + format_number(low) + " to " + format_number(high));
  const double step = (kWidth - 36.0) / static_cast<double>(kHeatLevels);
  for (std::size_t level = 0; level < kHeatLevels; ++level) {
    plot.path(fmt::format("h{}", level),
              fmt::format("M{} 2h{}v{}h{}z", px(12.0 + step * static_cast<double>(level)),
                          px(step + 0.3), px(kBar), px(-step - 0.3)));
  }
  plot.x_ticks({12.0, kWidth - 24.0, 2.0, kBar + 2.0}, scale);
  return plot.svg();
}

std::string draw(const ParallelChart& chart) {
  constexpr double kGap = 96.0, kAbove = 40.0, kSide = 48.0, kHigh = 230.0;
  const double width =
      std::max(kWidth, 2.0 * kSide + kGap * static_cast<double>(chart.axes.size() - 1));
  const double gap = (width - 2.0 * kSide) / static_cast<double>(chart.axes.size() - 1);
  const double bottom = kAbove + kHigh;
  const double failed_at = bottom + 22.0;
  std::vector<ChartScale> scales;
  for (const ParallelAxis& axis : chart.axes) {
    scales.emplace_back(axis.low, axis.high, axis.is_log, bottom, kAbove);
  }
  SvgPlot plot("parallel", width, bottom + 34.0,
               fmt::format("{} runs, a line each, coloured by {}", chart.lines.size(),
                           chart.axes.back().title),
               fmt::format(" style=\"min-width:{}px;max-width:{}px\"", px(width), px(1.6 * width)));
  bool any_failed = false;
  for (const bool failed : {false, true}) {  // failures lie on top
    for (const ParallelLine& line : chart.lines) {
      const double last = line.values.back();
      const bool has_value = std::isfinite(last) && !line.failed;
      if (line.failed != failed) continue;
      any_failed |= failed;
      std::vector<PlotPoint> points;
      for (std::size_t k = 0; k < chart.axes.size(); ++k) {
        const bool is_last = k + 1 == chart.axes.size();
        points.emplace_back(kSide + gap * static_cast<double>(k),
                            is_last && !has_value ? failed_at : scales[k](line.values[k]));
      }
      const std::string name = failed ? "failed"
                               : has_value
                                   ? fmt::format("h{}", heat_level(scales.back().share(last)))
                                   : "none";
      plot.path("p " + name, line_path(points), fmt::format(" data-r=\"{}\"", line.run));
    }
  }
  for (std::size_t k = 0; k < chart.axes.size(); ++k) {
    const ParallelAxis& axis = chart.axes[k];
    const double x = kSide + gap * static_cast<double>(k);
    plot.path("axis", fmt::format("M{} {}V{}", px(x), px(kAbove), px(bottom)));
    const bool is_first = k == 0, is_last = k + 1 == chart.axes.size();
    const double at = is_first ? 2.0 : is_last ? width - 2.0 : x;
    plot.text(at, k % 2 == 0 ? 12.0 : 27.0,
              is_first  ? "start"
              : is_last ? "end"
                        : "middle",
              shortened(axis.title, is_first || is_last ? 22 : 30), "title");
    const auto tick = [&](double value, const std::string& text) {
      const bool is_inside = is_last && !axis.texts.empty();  // there is no room on the right
      plot.text(is_inside ? x - 5.0 : x + 4.0, scales[k](value) + 3.5, is_inside ? "end" : "start",
                shortened(text, 12), "halo");
    };
    if (axis.texts.empty()) {
      for (const ChartScale::Tick& one : scales[k].ticks(4)) tick(one.value, one.label);
    } else {
      const std::size_t stride = 1 + axis.texts.size() / 12;
      for (std::size_t i = 0; i < axis.texts.size(); i += stride) {
        tick(static_cast<double>(i), axis.texts[i]);
      }
    }
  }
  if (any_failed) plot.text(width - 2.0, failed_at + 10.0, "end", "failed", "lost");
  return plot.svg();
}

std::string draw_box(const QuantileBand& band, Identity look, double low, double high) {
  constexpr double kBox = 150.0;
  SvgPlot plot(fmt::format("box {}", series_class(look)), kBox, 18.0, "");
  if (band.measured > 0) {
    const ChartScale x(low, high, is_for_log(low, high), 3.0, kBox - 3.0);
    plot.path("line", fmt::format("M{} 9H{}", px(x(band.q10)), px(x(band.q90))));
    plot.path("half", fmt::format("M{0} 4H{1}V14H{0}z", px(x(band.q25)), px(x(band.q75))));
    plot.path("middle", fmt::format("M{} 2V16", px(x(band.median))));
  }
  return plot.svg();
}

std::string draw_indices(const SensitivityIndex& first_order, const SensitivityIndex& total,
                         Identity look) {
  SvgPlot plot(fmt::format("box {}", series_class(look)), 150.0, 22.0, "");
  plot.path("axis", "M4 0V22M146 0V22");
  const auto x = [](double index) { return px(4.0 + 142.0 * std::clamp(index, -0.02, 1.02)); };
  const auto row = [&](const SensitivityIndex& index, double y, const char* name) {
    plot.path(name, fmt::format("M{} {}H{}v6H{}z", x(0.0), px(y - 3.0), x(index.value), x(0.0)));
    if (!index.interval) return;
    plot.path("whisker",
              fmt::format("M{} {}H{}", x(index.interval->lower), px(y), x(index.interval->upper)));
  };
  row(first_order, 6.0, "full");
  row(total, 16.0, "half");
  return plot.svg();
}

}  // namespace breakwater
