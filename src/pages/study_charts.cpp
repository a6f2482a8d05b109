#include <breakwater/pages/study_charts.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <breakwater/pages/chart_scale.h>
#include <breakwater/pages/html_page.h>

namespace breakwater {
namespace {

// In units of the drawing, which are pixels on a phone.
constexpr double kWidth = 360.0, kHeight = 250.0;
constexpr double kLeft = 50.0, kRight = 10.0, kTop = 12.0, kBottom = 40.0;
constexpr double kFailureRow = 8.0;  // height of the row of crosses
constexpr double kLetter = 6.2;      // width

// At most one decimal.
std::string px(double value) {
  std::string text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

std::string open_svg(double width, double height, const std::string& kind,
                     const std::string& about) {
  return fmt::format("<svg class=\"{}\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">",
                     kind, px(width), px(height), xml_text(about));
}

std::string label(double x, double y, const char* anchor, const std::string& text,
                  const char* more = "") {
  return fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\"{}>{}</text>", px(x), px(y), anchor,
                     more, xml_text(text));
}

// At most `most` letters, so that it stays in its place.
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

std::string refs(const std::vector<std::size_t>& runs) {
  return fmt::format("{}", fmt::join(runs, ","));
}

// The label that stands left of the vertical axis, above it.
std::string titles(const std::string& x_title) {
  return label(kLeft + 0.5 * (kWidth - kLeft - kRight), kHeight - 5.0, "middle",
               shortened(x_title, 50), " class=\"title\"");
}

std::string x_ticks(const std::vector<double>& places, const std::vector<std::string>& texts) {
  std::string svg;
  double free_from = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string text = shortened(texts[i], 14);
    const double half = 0.5 * kLetter * static_cast<double>(text.size());
    const double x = std::min(places[i], kWidth - half);
    svg +=
        fmt::format("<path class=\"tick\" d=\"M{} {}v4\"/>", px(places[i]), px(kHeight - kBottom));
    if (x - half < free_from) continue;
    svg += label(x, kHeight - kBottom + 15.0, "middle", text);
    free_from = x + half + 4.0;
  }
  return svg;
}

// A polygon around a band, where it has two marks or more side by side.
std::string band_path(const std::vector<LineMark>& marks, const ChartScale& x,
                      const ChartScale& y) {
  std::string path;
  for (std::size_t begin = 0; begin < marks.size();) {
    std::size_t end = begin;
    while (end < marks.size() && std::isfinite(marks[end].lower)) ++end;
    if (end - begin >= 2) {
      for (std::size_t i = begin; i < end; ++i) {
        path += fmt::format("{}{} {}", i == begin ? 'M' : 'L', px(x(marks[i].x)),
                            px(y(marks[i].upper)));
      }
      for (std::size_t i = end; i-- > begin;) {
        path += fmt::format("L{} {}", px(x(marks[i].x)), px(y(marks[i].lower)));
      }
      path += 'Z';
    }
    begin = end + 1;
  }
  return path;
}

std::string median_path(const std::vector<LineMark>& marks, const ChartScale& x,
                        const ChartScale& y) {
  std::string path;
  bool is_down = false;
  for (const LineMark& mark : marks) {
    if (std::isfinite(mark.y)) {
      path += fmt::format("{}{} {}", is_down ? 'L' : 'M', px(x(mark.x)), px(y(mark.y)));
    }
    is_down = std::isfinite(mark.y);
  }
  return path;
}

std::string cross(double x, double y, double half) {
  return fmt::format("M{} {}l{} {}m0 {}l{} {}", px(x - half), px(y - half), px(2.0 * half),
                     px(2.0 * half), px(-2.0 * half), px(-2.0 * half), px(2.0 * half));
}

std::size_t heat_level(double share) {
  return std::min(kHeatLevels - 1,
                  static_cast<std::size_t>(share * static_cast<double>(kHeatLevels)));
}

}  // namespace

std::string xml_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string draw(const LineChart& chart) {
  double low = chart.is_share ? 0.0 : std::numeric_limits<double>::infinity();
  double high = chart.is_share ? 1.0 : -low;
  bool has_failures = false;
  for (const auto& line : chart.lines) {
    for (const LineMark& mark : line) {
      has_failures |= mark.has_failures;
      if (!std::isfinite(mark.y) || chart.is_share) continue;
      low = std::min({low, mark.y, mark.lower});
      high = std::max({high, mark.y, mark.upper});
    }
  }
  const bool is_empty = !(low <= high);
  if (is_empty) low = 0.0, high = 1.0;
  const double crosses =
      has_failures ? kFailureRow * static_cast<double>(chart.lines.size()) + 4.0 : 0.0;
  const double bottom = kHeight - kBottom - crosses;
  const ChartScale y(low, high, is_for_log(low, high), bottom - 6.0, kTop + 6.0);
  const auto [first, last] = std::minmax_element(chart.x.begin(), chart.x.end());
  const double left = kLeft + 10.0, right = kWidth - kRight - 10.0;
  const ChartScale x(*first, *last, chart.is_log_x, left, right);

  std::string svg = open_svg(kWidth, kHeight, "lines", chart.y_title + " over " + chart.x_title);
  if (!is_empty) {
    for (const ChartScale::Tick& tick : y.ticks(5)) {
      svg += fmt::format("<path class=\"grid\" d=\"M{} {}H{}\"/>", px(kLeft), px(y(tick.value)),
                         px(kWidth - kRight));
      svg += label(kLeft - 5.0, y(tick.value) + 3.5, "end", tick.label);
    }
  }
  svg += fmt::format("<path class=\"axis\" d=\"M{} {}V{}H{}\"/>", px(kLeft), px(kTop),
                     px(kHeight - kBottom), px(kWidth - kRight));
  std::vector<double> places;
  std::vector<std::string> texts = chart.x_labels;
  if (!texts.empty()) {
    for (const double value : chart.x) places.push_back(x(value));
  } else {
    for (const ChartScale::Tick& tick : x.ticks(5)) {
      places.push_back(x(tick.value));
      texts.push_back(tick.label);
    }
  }
  svg += x_ticks(places, texts) + titles(chart.x_title);
  for (std::size_t c = 0; c < chart.lines.size(); ++c) {
    const std::string band = chart.is_share ? "" : band_path(chart.lines[c], x, y);
    if (!band.empty()) svg += fmt::format("<path class=\"band c{}\" d=\"{}\"/>", c % 10, band);
  }
  for (std::size_t c = 0; c < chart.lines.size(); ++c) {
    const std::string name = fmt::format("c{}{}", c % 10, c < 10 ? "" : " dashed");
    const std::string path = median_path(chart.lines[c], x, y);
    if (!path.empty()) svg += fmt::format("<path class=\"line {}\" d=\"{}\"/>", name, path);
    svg += fmt::format("<g class=\"{}\">", name);
    for (const LineMark& mark : chart.lines[c]) {
      if (!std::isfinite(mark.y) && !mark.has_failures) continue;
      svg += fmt::format("<g class=\"m\" data-r=\"{}\"><title>{}</title>", refs(mark.runs),
                         xml_text(mark.text));
      if (std::isfinite(mark.y)) {
        if (chart.x.size() == 1) {  // a band without width
          svg += fmt::format("<path class=\"line\" d=\"M{} {}V{}\"/>", px(x(mark.x)),
                             px(y(mark.lower)), px(y(mark.upper)));
        }
        svg += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"3\"/>", px(x(mark.x)), px(y(mark.y)));
      }
      if (mark.has_failures) {
        const double row = bottom + kFailureRow * (static_cast<double>(c) + 0.5) + 2.0;
        svg += fmt::format("<path class=\"x\" d=\"{}\"/>", cross(x(mark.x), row, 3.0));
      }
      svg += "</g>";
    }
    svg += "</g>";
  }
  if (is_empty) {
    svg += label(0.5 * (kLeft + kWidth), 0.5 * kHeight, "middle", "no run has it");
  }
  return svg + "</svg>";
}

std::string draw(const HeatMap& map) {
  constexpr std::size_t kLongestRow = 20;  // letters
  const auto columns = map.x_labels.size(), rows = map.y_labels.size();
  std::size_t longest = 0;
  for (const std::string& text : map.y_labels) longest = std::max(longest, text.size());
  // Left of the cells there is room for the rows' labels.
  const double labels =
      std::max(66.0, 8.0 + kLetter * static_cast<double>(std::min(longest, kLongestRow)));
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
              label(x + 0.5 * width, y + 0.5 * height + 3.5, "middle", format_number(cell.value),
                    level < kHeatLevels * 6 / 10 ? " class=\"on dark\"" : " class=\"on\"");
        }
      } else if (cell.runs > 0 && cell.failed < cell.runs) {
        absent +=
            fmt::format("M{} {}h{}", px(x + 0.35 * width), px(y + 0.5 * height), px(0.3 * width));
      }
      const double half = 0.3 * std::min(width, height);
      if (cell.runs > 0 && cell.failed == cell.runs) {
        dead += cross(x + 0.5 * width, y + 0.5 * height, half);
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

  std::string svg = fmt::format(
      "<svg class=\"heat\" viewBox=\"0 0 {} {}\" role=\"img\" tabindex=\"0\" aria-label=\"{}\" "
      "data-grid=\"{} {} {} {} {} {}\" data-x=\"{}\" data-y=\"{}\" data-x-title=\"{}\" "
      "data-y-title=\"{}\" data-v=\"{}\" data-n=\"{}\" "
      "data-r=\"{}\">",
      px(kWidth), px(bottom + kBottom), xml_text(map.about), px(labels), px(bottom),
      fmt::format("{:.4f}", width), fmt::format("{:.4f}", height), columns, rows,
      xml_text(fmt::format("{}", fmt::join(map.x_labels, "\n"))),
      xml_text(fmt::format("{}", fmt::join(map.y_labels, "\n"))), xml_text(map.x_title),
      xml_text(map.y_title), values, counts, runs);
  for (std::size_t level = 0; level < kHeatLevels; ++level) {
    if (!levels[level].empty())
      svg += fmt::format("<path class=\"h{}\" d=\"{}\"/>", level, levels[level]);
  }
  svg += fmt::format("<path class=\"frame\" d=\"M{} {}H{}V{}H{}z\"/>", px(labels), px(kTop),
                     px(kWidth - kRight), px(bottom), px(labels));
  svg += texts;
  if (!absent.empty()) svg += fmt::format("<path class=\"absent\" d=\"{}\"/>", absent);
  if (!dead.empty()) svg += fmt::format("<path class=\"dead\" d=\"{}\"/>", dead);
  if (!some.empty()) svg += fmt::format("<path class=\"some\" d=\"{}\"/>", some);
  const auto letters = std::max<std::size_t>(14, static_cast<std::size_t>(width / kLetter));
  double free_from = 0.0;
  for (std::size_t column = 0; column < columns; ++column) {
    const std::string text = shortened(map.x_labels[column], letters);
    const double half = 0.5 * kLetter * static_cast<double>(text.size());
    const double x = std::min(labels + width * (static_cast<double>(column) + 0.5), kWidth - half);
    if (x - half < free_from) continue;
    svg += label(x, bottom + 14.0, "middle", text);
    free_from = x + half + 4.0;
  }
  double free_above = bottom + 20.0;
  for (std::size_t row = 0; row < rows; ++row) {
    const double y = bottom - height * (static_cast<double>(row) + 0.5) + 3.5;
    if (y > free_above) continue;
    svg += label(labels - 5.0, y, "end", shortened(map.y_labels[row], kLongestRow));
    free_above = y - 13.0;
  }
  svg += label(0.5 * (labels + kWidth - kRight), bottom + kBottom - 7.0, "middle",
               shortened(map.x_title, 48), " class=\"title\"");
  svg += label(2.0, kTop - 3.0, "start", shortened(map.y_title, 52), " class=\"title\"");
  return svg + "<path class=\"at\" d=\"\"/></svg>";
}

std::string draw_colour_bar(double low, double high) {
  constexpr double kBar = 14.0;
  const ChartScale scale(low, high, is_for_log(low, high), 12.0, kWidth - 24.0);
  std::string svg = open_svg(kWidth, 36.0, "bar",
                             "colours from " + format_number(low) + " to " + format_number(high));
  const double step = (kWidth - 36.0) / static_cast<double>(kHeatLevels);
  for (std::size_t level = 0; level < kHeatLevels; ++level) {
    svg += fmt::format("<path class=\"h{}\" d=\"M{} 2h{}v{}h{}z\"/>", level,
                       px(12.0 + step * static_cast<double>(level)), px(step + 0.3), px(kBar),
                       px(-step - 0.3));
  }
  for (const ChartScale::Tick& tick : scale.ticks(5)) {
    svg +=
        fmt::format("<path class=\"tick\" d=\"M{} {}v4\"/>", px(scale(tick.value)), px(kBar + 2.0));
    svg += label(scale(tick.value), 32.0, "middle", tick.label);
  }
  return svg + "</svg>";
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
  std::string svg = fmt::format(
      "<svg class=\"parallel\" style=\"min-width:{}px;max-width:{}px\" viewBox=\"0 0 {} {}\" "
      "role=\"img\" aria-label=\"{}\">",
      px(width), px(1.6 * width), px(width), px(bottom + 34.0),
      xml_text(fmt::format("{} runs, a line each, coloured by {}", chart.lines.size(),
                           chart.axes.back().title)));
  bool any_failed = false;
  for (const bool failed : {false, true}) {  // failures lie on top
    for (const ParallelLine& line : chart.lines) {
      const double last = line.values.back();
      const bool has_value = std::isfinite(last) && !line.failed;
      if (line.failed != failed) continue;
      any_failed |= failed;
      std::string path;
      for (std::size_t k = 0; k < chart.axes.size(); ++k) {
        const bool is_last = k + 1 == chart.axes.size();
        const double y = is_last && !has_value ? failed_at : scales[k](line.values[k]);
        path += fmt::format("{}{} {}", k == 0 ? 'M' : 'L', px(kSide + gap * static_cast<double>(k)),
                            px(y));
      }
      const std::string name = failed ? "failed"
                               : has_value
                                   ? fmt::format("h{}", heat_level(scales.back().share(last)))
                                   : "none";
      svg += fmt::format("<path class=\"p {}\" d=\"{}\" data-r=\"{}\"/>", name, path, line.run);
    }
  }
  for (std::size_t k = 0; k < chart.axes.size(); ++k) {
    const ParallelAxis& axis = chart.axes[k];
    const double x = kSide + gap * static_cast<double>(k);
    svg += fmt::format("<path class=\"axis\" d=\"M{} {}V{}\"/>", px(x), px(kAbove), px(bottom));
    const bool is_first = k == 0, is_last = k + 1 == chart.axes.size();
    const double at = is_first ? 2.0 : is_last ? width - 2.0 : x;
    svg += label(at, k % 2 == 0 ? 12.0 : 27.0,
                 is_first  ? "start"
                 : is_last ? "end"
                           : "middle",
                 shortened(axis.title, is_first || is_last ? 22 : 30), " class=\"title\"");
    const auto tick = [&](double value, const std::string& text) {
      const bool is_inside = is_last && !axis.texts.empty();  // there is no room on the right
      svg += label(is_inside ? x - 5.0 : x + 4.0, scales[k](value) + 3.5,
                   is_inside ? "end" : "start", shortened(text, 12), " class=\"halo\"");
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
  if (any_failed) svg += label(width - 2.0, failed_at + 10.0, "end", "failed", " class=\"lost\"");
  return svg + "</svg>";
}

std::string draw_box(const QuantileBand& band, std::size_t colour, double low, double high) {
  constexpr double kBox = 150.0;
  std::string svg = fmt::format(
      "<svg class=\"box c{}\" viewBox=\"0 0 {} 18\" aria-hidden=\"true\">", colour % 10, kBox);
  if (band.measured > 0) {
    const ChartScale x(low, high, is_for_log(low, high), 3.0, kBox - 3.0);
    svg += fmt::format(
        "<path class=\"line\" d=\"M{0} 9H{1}\"/><path class=\"half\" d=\"M{2} 4H{3}V14H{2}z\"/>"
        "<path class=\"middle\" d=\"M{4} 2V16\"/>",
        px(x(band.q10)), px(x(band.q90)), px(x(band.q25)), px(x(band.q75)), px(x(band.median)));
  }
  return svg + "</svg>";
}

std::string draw_indices(const SensitivityIndex& first_order, const SensitivityIndex& total,
                         std::size_t colour) {
  constexpr double kBox = 150.0;
  const auto x = [](double index) { return px(4.0 + 142.0 * std::clamp(index, -0.02, 1.02)); };
  const auto row = [&](const SensitivityIndex& index, double y, const char* name) {
    std::string svg = fmt::format("<path class=\"{}\" d=\"M{} {}H{}v6H{}z\"/>", name, x(0.0),
                                  px(y - 3.0), x(index.value), x(0.0));
    if (index.interval) {
      svg += fmt::format("<path class=\"whisker\" d=\"M{} {}H{}\"/>", x(index.interval->lower),
                         px(y), x(index.interval->upper));
    }
    return svg;
  };
  return fmt::format(
             "<svg class=\"box c{}\" viewBox=\"0 0 {} 22\" aria-hidden=\"true\">"
             "<path class=\"axis\" d=\"M4 0V22M146 0V22\"/>",
             colour % 10, kBox) +
         row(first_order, 6.0, "full") + row(total, 16.0, "half") + "</svg>";
}

}  // namespace breakwater
