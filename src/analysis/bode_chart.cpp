#include <breakwater/analysis/bode_chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <breakwater/pages/svg_plot.h>

namespace breakwater {
namespace {

constexpr double kWidth = 420.0, kHeight = 348.0;
constexpr PlotArea kGain{48.0, kWidth - 12.0, 12.0, 190.0};
constexpr PlotArea kPhase{kGain.left, kGain.right, 206.0, 310.0};
constexpr double kDeep_dB = 120.0, kLow_dB = -60.0;  // values below both limits are not drawn

double dB(std::complex<double> gain) {
  return 20.0 * std::log10(std::abs(gain));
}

// Unwrapped phases in degrees, the first within ±180.
std::vector<double> phases(const BodeCurve& curve) {
  std::vector<double> result;
  for (const std::complex<double>& gain : curve.gain) {
    double phase = std::arg(gain) * 180.0 / std::numbers::pi;
    if (!result.empty()) phase += 360.0 * std::round((result.back() - phase) / 360.0);
    result.push_back(phase);
  }
  return result;
}

// Adds whole turns to each mark until it is nearest to the line. Marks are too far apart to be
// unwrapped alone.
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

ChartScale upwards(const PlotRange& range, const PlotArea& area) {
  return {range.low, range.high, false, area.bottom - 5.0, area.top + 5.0};
}

// A line with a gap where it is outside the range.
std::string curve(const std::vector<double>& at, const std::vector<double>& values,
                  const ChartScale& x, const ChartScale& y, const PlotRange& within) {
  std::vector<PlotPoint> points;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const bool is_seen = values[i] >= within.low && values[i] <= within.high;
    points.emplace_back(x(at[i]), is_seen ? y(values[i]) : std::nan(""));
  }
  return line_path(points);
}

// The phase margin at the crossover, from a half turn to the line; the gain margin below 0 dB.
std::string margin_marks(const BodeLoop& loop, const std::vector<double>& phases,
                         const ChartScale& x, const ChartScale& gain, const ChartScale& phase) {
  const LoopMargins& margins = *loop.margins;
  std::string svg;
  const auto mark = [&](double omega, double from, double to, const std::string& text) {
    svg += fmt::format(
        "<g><title>{}</title><path class=\"margin\" d=\"M{} {}m-4 0h8m-4 0V{}m-4 0h8\"/></g>",
        xml_text(text), px(x(omega)), px(from), px(to));
  };
  const auto& at = loop.line.omega_rad_s;
  if (std::isfinite(margins.phase_margin_rad)) {
    const auto next = std::lower_bound(at.begin(), at.end(), margins.crossover_rad_s);
    const auto i = std::min(static_cast<std::size_t>(next - at.begin()), at.size() - 1);
    const double half_turn = -180.0 + 360.0 * std::round((phases[i] + 180.0) / 360.0);
    mark(margins.crossover_rad_s, phase(half_turn), phase(phases[i]),
         fmt::format("{}, phase margin {:.1f} deg", loop.label,
                     margins.phase_margin_rad * 180.0 / std::numbers::pi));
  }
  if (std::isfinite(margins.gain_margin)) {
    const double dB_margin = 20.0 * std::log10(margins.gain_margin);
    mark(margins.gain_margin_rad_s, gain(0.0), gain(-dB_margin),
         fmt::format("{}, gain margin {:.1f} dB", loop.label, dB_margin));
  }
  return svg;
}

}  // namespace

std::string draw_bode(const std::string& title, const std::string& unit,
                      const std::vector<BodeLoop>& loops) {
  struct Drawn {
    std::vector<double> line_dB, line_phase, mark_dB, mark_phase;
  };
  std::vector<Drawn> drawn;
  PlotRange omega, gains, turns;
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
  const ChartScale x(omega.low, omega.high, true, kGain.left + 6.0, kGain.right - 6.0);
  const ChartScale gain = upwards(gains, kGain);
  const ChartScale phase = upwards(turns, kPhase);

  SvgPlot plot("bode", kWidth, kHeight,
               title +
                   ": gain and phase over frequency; the table and analysis.csv have the "
                   "numbers");
  for (const auto& [area, y, name] :
       {std::tuple(kGain, gain, unit.empty() ? "gain [dB]" : "gain [dB of " + unit + "]"),
        std::tuple(kPhase, phase, std::string("phase [deg]"))}) {
    plot.y_grid(area, y);
    plot.x_grid(area, x);
    plot.frame(area);
    plot.y_title(area, name);
  }
  plot.x_ticks(kPhase, x);
  plot.x_title(kPhase, "frequency [rad/s]");
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const BodeLoop& loop = loops[i];
    const std::string name = series_class(loop.look);
    plot.path("line " + name, curve(loop.line.omega_rad_s, drawn[i].line_dB, x, gain, gains));
    plot.path("line " + name, curve(loop.line.omega_rad_s, drawn[i].line_phase, x, phase, turns));
    plot.add(fmt::format("<g class=\"{}\">", name));
    for (std::size_t k = 0; k < loop.marks.gain.size(); ++k) {
      if (drawn[i].mark_dB[k] < gains.low) continue;
      const double at = x(loop.marks.omega_rad_s[k]);
      const bool is_unsure = !loop.marks.is_unsure.empty() && loop.marks.is_unsure[k];
      plot.add(fmt::format(
          "<g class=\"m{}\"><title>{}</title>{}{}</g>", is_unsure ? " unsure" : "",
          xml_text(fmt::format("{}, measured {}at {:.4g} rad/s: {:.2f} dB, {:.1f} deg", loop.label,
                               is_unsure ? "without certainty " : "", loop.marks.omega_rad_s[k],
                               drawn[i].mark_dB[k], drawn[i].mark_phase[k])),
          svg_dot(at, gain(drawn[i].mark_dB[k])), svg_dot(at, phase(drawn[i].mark_phase[k]))));
    }
    if (loop.margins) plot.add(margin_marks(loop, drawn[i].line_phase, x, gain, phase));
    plot.add("</g>");
  }
  return plot.svg();
}

}  // namespace breakwater
