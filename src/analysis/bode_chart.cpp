#include <breakwater/analysis/bode_chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <breakwater/pages/chart_scale.h>
#include <breakwater/pages/study_charts.h>

namespace breakwater {
namespace {

// In units of the drawing.
constexpr double kWidth = 420.0, kLeft = 48.0, kRight = 12.0;
constexpr double kGainTop = 12.0, kGainBottom = 190.0, kPhaseTop = 206.0, kPhaseBottom = 310.0;
constexpr double kHeight = 348.0;
constexpr double kDeep_dB = 120.0, kLow_dB = -60.0;  // what is lower than both is no news
constexpr int kTicks = 5;

double dB(std::complex<double> gain) {
  return 20.0 * std::log10(std::abs(gain));
}

// Unwrapped degrees, the first within ±180.
std::vector<double> phases(const BodeCurve& curve) {
  std::vector<double> result;
  for (const std::complex<double>& gain : curve.gain) {
    double phase = std::arg(gain) * 180.0 / std::numbers::pi;
    if (!result.empty()) phase += 360.0 * std::round((result.back() - phase) / 360.0);
    result.push_back(phase);
  }
  return result;
}

// Each mark on the turn that is nearest to the line: marks are too far apart to be unwrapped alone.
void bring_near(std::vector<double>& marks, const BodeCurve& at, const std::vector<double>& line,
                const BodeCurve& line_at) {
  if (line.empty()) return;
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const auto next =
        std::lower_bound(line_at.omega_rad_s.begin(), line_at.omega_rad_s.end(), at.omega_rad_s[k]);
    const auto i =
        std::min(static_cast<std::size_t>(next - line_at.omega_rad_s.begin()), line.size() - 1);
    marks[k] += 360.0 * std::round((line[i] - marks[k]) / 360.0);
  }
}

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool is_empty() const { return !(low <= high); }
};

struct Panel {
  double top, bottom;
  std::string title;
};

std::string text(double x, double y, const char* anchor, const std::string& words,
                 const char* style = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>", x, y, anchor,
                     style, xml_text(words));
}

std::string frame(const Panel& panel, const ChartScale& x, const ChartScale& y, bool has_x_labels) {
  std::string svg;
  for (const ChartScale::Tick& tick : y.ticks(kTicks)) {
    svg += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>", kLeft, y(tick.value),
                       kWidth - kRight);
    svg += text(kLeft - 5.0, y(tick.value) + 3.5, "end", tick.label);
  }
  for (const ChartScale::Tick& tick : x.ticks(kTicks)) {
    svg += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", x(tick.value),
                       panel.top, panel.bottom);
    if (has_x_labels) svg += text(x(tick.value), panel.bottom + 15.0, "middle", tick.label);
  }
  svg += fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\"/>", kLeft, panel.top,
                     panel.bottom, kWidth - kRight);
  const double middle = 0.5 * (panel.top + panel.bottom);
  return svg + fmt::format(
                   "<text class=\"title\" text-anchor=\"middle\" "
                   "transform=\"translate(12 {:.1f}) rotate(-90)\">{}</text>",
                   middle, xml_text(panel.title));
}

std::string line_path(const std::vector<double>& at, const std::vector<double>& values,
                      const ChartScale& x, const ChartScale& y, const Extent& within) {
  std::string path;
  bool is_down = false;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const bool is_seen = values[i] >= within.low && values[i] <= within.high;
    if (is_seen) {
      path += fmt::format("{}{:.1f} {:.1f}", is_down ? 'L' : 'M', x(at[i]), y(values[i]));
    }
    is_down = is_seen;
  }
  return path;
}

}  // namespace

std::string draw_bode(const std::string& title, const std::string& unit,
                      const std::vector<BodeLoop>& loops) {
  struct Drawn {
    std::vector<double> line_dB, line_phase, mark_dB, mark_phase;
  };
  std::vector<Drawn> drawn;
  Extent omega, gains, turns;
  for (const BodeLoop& loop : loops) {
    Drawn one{{}, phases(loop.line), {}, phases(loop.marks)};
    bring_near(one.mark_phase, loop.marks, one.line_phase, loop.line);
    for (const auto& gain : loop.line.gain) one.line_dB.push_back(dB(gain));
    for (const auto& gain : loop.marks.gain) one.mark_dB.push_back(dB(gain));
    for (const double value : loop.line.omega_rad_s) omega.add(value);
    for (const double value : loop.marks.omega_rad_s) omega.add(value);
    for (const double value : one.line_dB) gains.add(value);
    for (const double value : one.mark_dB) gains.add(value);
    for (const double value : one.line_phase) turns.add(value);
    for (const double value : one.mark_phase) turns.add(value);
    drawn.push_back(std::move(one));
  }
  if (omega.is_empty() || gains.is_empty()) return "";
  gains.low = std::max(gains.low, std::min(gains.high - kDeep_dB, kLow_dB));
  const ChartScale x(omega.low, omega.high, true, kLeft + 6.0, kWidth - kRight - 6.0);
  const ChartScale gain(gains.low, gains.high, false, kGainBottom - 5.0, kGainTop + 5.0);
  const ChartScale phase(turns.low, turns.high, false, kPhaseBottom - 5.0, kPhaseTop + 5.0);

  std::string svg = fmt::format(
      "<svg class=\"bode\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", kWidth, kHeight,
      xml_text(title + ": gain and phase over frequency; the table and analysis.csv have the "
                       "numbers"));
  svg += frame({kGainTop, kGainBottom, unit.empty() ? "gain [dB]" : "gain [dB of " + unit + "]"}, x,
               gain, false);
  svg += frame({kPhaseTop, kPhaseBottom, "phase [deg]"}, x, phase, true);
  svg += text(0.5 * (kLeft + kWidth - kRight), kHeight - 6.0, "middle", "frequency [rad/s]",
              " class=\"title\"");
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const BodeLoop& loop = loops[i];
    const std::string name = fmt::format("c{}{}", i % 10, i < 10 ? "" : " dashed");
    for (const std::string& path :
         {line_path(loop.line.omega_rad_s, drawn[i].line_dB, x, gain, gains),
          line_path(loop.line.omega_rad_s, drawn[i].line_phase, x, phase, turns)}) {
      if (!path.empty()) svg += fmt::format("<path class=\"line {}\" d=\"{}\"/>", name, path);
    }
    svg += fmt::format("<g class=\"{}\">", name);
    for (std::size_t k = 0; k < loop.marks.gain.size(); ++k) {
      if (drawn[i].mark_dB[k] < gains.low) continue;
      const double at = x(loop.marks.omega_rad_s[k]);
      svg += fmt::format(
          "<g class=\"m\"><title>{}</title><circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>"
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/></g>",
          xml_text(fmt::format("{}, measured at {:.4g} rad/s: {:.2f} dB, {:.1f} deg", loop.label,
                               loop.marks.omega_rad_s[k], drawn[i].mark_dB[k],
                               drawn[i].mark_phase[k])),
          at, gain(drawn[i].mark_dB[k]), at, phase(drawn[i].mark_phase[k]));
    }
    svg += "</g>";
  }
  return svg + "</svg>";
}

}  // namespace breakwater
