#include <breakwater/analysis/bode_chart.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/pages/page_chart.h>

namespace breakwater {
namespace {

constexpr double kInDegrees = 180.0 / std::numbers::pi;
constexpr double kDeep_dB = 120.0, kLow_dB = -60.0;  // values below both limits are not drawn

double dB(double gain) {
  return 20.0 * std::log10(gain);
}

std::vector<double> gains(const BodeCurve& curve) {
  std::vector<double> result;
  for (const std::complex<double>& gain : curve.gain) result.push_back(dB(std::abs(gain)));
  return result;
}

// Unwrapped phases in degrees, the first within ±180.
std::vector<double> phases(const BodeCurve& curve) {
  std::vector<double> result;
  for (const std::complex<double>& gain : curve.gain) {
    double phase = std::arg(gain) * kInDegrees;
    if (!result.empty()) phase += 360.0 * std::round((result.back() - phase) / 360.0);
    result.push_back(phase);
  }
  return result;
}

// The value of a line at a frequency, or at the next one that it has.
double at(const BodeCurve& line, const std::vector<double>& values, double omega_rad_s) {
  const auto& all = line.omega_rad_s;
  const auto next = std::lower_bound(all.begin(), all.end(), omega_rad_s) - all.begin();
  return values[std::min(static_cast<std::size_t>(next), values.size() - 1)];
}

double nearest_turn(double phase, double to) {
  return phase + 360.0 * std::round((to - phase) / 360.0);
}

// The designed line and the measured marks; those that are not sure are grey.
void add_series(const BodeLoop& loop, const std::vector<double>& line,
                const std::vector<double>& marks, PageChart& chart) {
  const auto series = [&](const char* what, Identity look, const char* kind) {
    ChartSeries one{.label = loop.label + what, .identity = look, .has_line = *kind == '\0'};
    one.marks = kind;
    return one;
  };
  ChartSeries designed = series("", loop.look, "");
  ChartSeries measured = series(", measured", loop.look, "dot");
  ChartSeries unsure = series(", not reliable", kReferenceIdentity, "dot");
  for (std::size_t k = 0; k < line.size(); ++k) {
    designed.values.times_s.push_back(std::log10(loop.line.omega_rad_s[k]));
    designed.values.values.push_back(line[k]);
  }
  for (std::size_t k = 0; k < marks.size(); ++k) {
    Series& values =
        (loop.marks.is_unsure.empty() || !loop.marks.is_unsure[k] ? measured : unsure).values;
    values.times_s.push_back(std::log10(loop.marks.omega_rad_s[k]));
    values.values.push_back(marks[k]);
  }
  for (ChartSeries& one : {std::ref(designed), std::ref(measured), std::ref(unsure)}) {
    if (!one.values.values.empty()) chart.series.push_back(std::move(one));
  }
}

// The phase margin at the crossover, from a half turn to the line; the gain margin below 0 dB.
void add_margins(const BodeLoop& loop, const std::vector<double>& line, PageChart& gain,
                 PageChart& phase) {
  const LoopMargins& margins = *loop.margins;
  if (std::isfinite(margins.phase_margin_rad)) {
    const double end = at(loop.line, line, margins.crossover_rad_s);
    phase.brackets.push_back({std::log10(margins.crossover_rad_s), nearest_turn(-180.0, end), end,
                              fmt::format("{}, phase margin {:.1f} deg", loop.label,
                                          margins.phase_margin_rad * kInDegrees),
                              loop.look});
  }
  if (std::isfinite(margins.gain_margin)) {
    const double margin = dB(margins.gain_margin);
    gain.brackets.push_back({std::log10(margins.gain_margin_rad_s), 0.0, -margin,
                             fmt::format("{}, gain margin {:.1f} dB", loop.label, margin),
                             loop.look});
  }
}

// Leaves a gap where a line is too low to be drawn, and no mark.
void cut_below(double lowest, PageChart& chart) {
  for (ChartSeries& one : chart.series) {
    for (double& value : one.values.values) {
      if (value < lowest) value = std::nan("");
    }
  }
}

}  // namespace

PageData bode_charts(const std::string& id, const std::string& unit,
                     const std::vector<BodeLoop>& loops) {
  PageChart gain{.id = id + "-gain", .group = id, .title = "gain"}, phase = gain;
  phase.id = id + "-phase";
  phase.title = "phase [deg]";
  gain.title += unit.empty() ? " [dB]" : " [dB of " + unit + "]";
  double highest = -kDeep_dB;
  for (PageChart* chart : {&gain, &phase}) {
    chart->x_title = "frequency [rad/s]";
    chart->is_log_x = true;
  }
  for (const BodeLoop& loop : loops) {
    add_series(loop, gains(loop.line), gains(loop.marks), gain);
    const std::vector<double> line = phases(loop.line);
    std::vector<double> marks = phases(loop.marks);
    // Marks are too far apart to be unwrapped alone.
    for (std::size_t k = 0; k < marks.size() && !line.empty(); ++k) {
      marks[k] = nearest_turn(marks[k], at(loop.line, line, loop.marks.omega_rad_s[k]));
    }
    add_series(loop, line, marks, phase);
    if (loop.margins) add_margins(loop, line, gain, phase);
  }
  for (const ChartSeries& one : gain.series) {
    for (const double value : one.values.values) highest = std::max(highest, value);
  }
  cut_below(std::min(highest - kDeep_dB, kLow_dB), gain);
  if (gain.series.empty()) return PageData::array();
  return {gain.json(), phase.json()};
}

}  // namespace breakwater
