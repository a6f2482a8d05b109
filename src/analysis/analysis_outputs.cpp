#include <breakwater/analysis/analysis_outputs.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <breakwater/analysis/bode_chart.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/record/csv.h>
#include <breakwater/record/partial_file.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

// A frequency response in the charts and tables.
struct Response {
  const char* name;  // name of its columns
  std::complex<double> LoopPoint::*value;
  bool needs_estimator;
  std::string title;
  std::string about;
  std::string unit;
};

std::vector<Response> responses(const AxisUnits& units) {
  return {
      {"d_hat_over_d", &LoopPoint::d_hat_over_d, true, "From the disturbance to its estimate",
       "1 means that the estimate equals the disturbance. The loop is closed.", ""},
      {"noise_to_d_hat", &LoopPoint::noise_to_d_hat, true,
       "From the sensor’s noise to the estimated disturbance",
       "Effect of an error of the measured position on the estimated disturbance.",
       units.force + "/" + units.position},
      {"noise_to_velocity_hat", &LoopPoint::noise_to_v_hat, true,
       "From the sensor’s noise to the estimated velocity",
       "Effect of an error of the measured position on the estimated velocity.",
       units.velocity + "/" + units.position},
      {"sensitivity", &LoopPoint::sensitivity, false, "Sensitivity S = 1/(1 + L)",
       "Share of a disturbance that remains at the plant’s input. Its peak is M_s.", ""},
      {"complementary", &LoopPoint::complementary, false, "Complementary sensitivity T = L/(1 + L)",
       "Reaction of the drive to a disturbance. Its peak is M_t.", ""},
      {"loop_gain", &LoopPoint::loop_gain, false, "Loop gain L",
       "The loop is opened at the plant’s input. Brackets: the designed phase and gain margins.",
       ""}};
}

struct Way {
  const char* name;
  LoopCurve LoopAnalysis::*curve;
};
constexpr std::array<Way, 2> kWays = {
    {{"designed", &LoopAnalysis::designed}, {"measured", &LoopAnalysis::measured}}};

// An existing curve of a loop, designed or measured.
struct NamedCurve {
  const LoopAnalysis& loop;
  const Way& way;
  const LoopCurve& curve;
};

std::vector<NamedCurve> curves_of(const std::vector<LoopAnalysis>& loops) {
  std::vector<NamedCurve> curves;
  for (const LoopAnalysis& loop : loops) {
    for (const Way& way : kWays) {
      const LoopCurve& curve = loop.*way.curve;
      if (!curve.points.empty()) curves.push_back({loop, way, curve});
    }
  }
  return curves;
}

double in_dB(double gain) {
  return 20.0 * std::log10(gain);
}

struct Quantity {
  const char* column;
  const char* words;
  std::function<double(const LoopCurve&)> of;
  // The frequency at which it is read. Empty: none stands for it.
  std::function<double(const LoopCurve&)> at_rad_s = {};
};

const std::vector<Quantity>& quantities() {
  const auto bandwidth = [](const LoopCurve& c) { return c.bandwidth_rad_s; };
  const auto crossover = [](const LoopCurve& c) { return c.margins.crossover_rad_s; };
  const auto phase_crossover = [](const LoopCurve& c) { return c.margins.gain_margin_rad_s; };
  static const std::vector<Quantity> all = {
      {"bandwidth_rad_s", "bandwidth of d_hat/d, −3 dB [rad/s]", bandwidth, bandwidth},
      {"crossover_rad_s", "crossover |L| = 1 [rad/s]", crossover, crossover},
      {"phase_margin_deg", "phase margin [deg]",
       [](const LoopCurve& c) { return c.margins.phase_margin_rad * kDegrees; }, crossover},
      {"gain_margin_dB", "gain margin [dB]",
       [](const LoopCurve& c) { return in_dB(c.margins.gain_margin); }, phase_crossover},
      {"gain_reduction_margin_dB", "gain reduction margin [dB]",
       [](const LoopCurve& c) { return in_dB(c.margins.gain_reduction_margin); }},
      {"delay_margin_ms", "delay margin [ms]",
       [](const LoopCurve& c) { return 1e3 * c.margins.delay_margin_s; }, crossover},
      {"sensitivity_peak_1", "M_s, largest sensitivity",
       [](const LoopCurve& c) { return c.margins.sensitivity_peak; }},
      {"complementary_peak_1", "M_t, largest complementary sensitivity",
       [](const LoopCurve& c) { return c.margins.complementary_peak; }}};
  return all;
}

std::string digits(double value) {
  return std::isfinite(value) ? fmt::format("{:.17g}", value) : "";
}

std::string points_csv(const std::vector<LoopAnalysis>& loops, const std::vector<Response>& all) {
  std::vector<std::string> header = {"case", "axis", "way", "omega_rad_s"};
  for (const Response& response : all) {
    header.push_back(std::string(response.name) + "_gain");
    header.push_back(std::string(response.name) + "_phase_deg");
  }
  header.insert(header.end(), {"spread_1", "saturated_1"});
  std::string text = csv_line(header);
  for (const LoopAnalysis& loop : loops) {
    for (const Way& way : kWays) {
      for (const LoopPoint& point : (loop.*way.curve).points) {
        std::vector<std::string> row = {loop.name.case_name, loop.name.axis, way.name,
                                        digits(point.omega_rad_s)};
        for (const Response& response : all) {
          const bool is_there = loop.estimates || !response.needs_estimator;
          const std::complex<double> value = point.*response.value;
          row.push_back(is_there ? digits(std::abs(value)) : "");
          row.push_back(is_there ? digits(std::arg(value) * kDegrees) : "");
        }
        row.push_back(digits(point.spread));
        row.push_back(digits(point.saturated));
        text += csv_line(row);
      }
    }
  }
  return text;
}

std::string margins_csv(const std::vector<LoopAnalysis>& loops) {
  std::vector<std::string> header = {"case", "axis", "way"};
  for (const Quantity& quantity : quantities()) header.emplace_back(quantity.column);
  std::string text = csv_line(header);
  for (const auto& [loop, way, curve] : curves_of(loops)) {
    std::vector<std::string> row = {loop.name.case_name, loop.name.axis, way.name};
    for (const Quantity& quantity : quantities()) row.push_back(digits(quantity.of(curve)));
    text += csv_line(row);
  }
  return text;
}

// A measured point counts if its windows agree, and the drive does anything about the probe.
bool is_reliable(const LoopPoint& point) {
  constexpr double kMostSpread = 0.2;
  return point.spread <= kMostSpread && std::abs(point.complementary) > 1e-9;
}

// The measured points on both sides of a frequency, which lies between them. Needs two points.
std::pair<const LoopPoint&, const LoopPoint&> around(const std::vector<LoopPoint>& points,
                                                     double omega_rad_s) {
  const auto above =
      std::find_if(points.begin() + 1, points.end() - 1,
                   [&](const LoopPoint& point) { return point.omega_rad_s >= omega_rad_s; });
  return {*(above - 1), *above};
}

// Whether a number in the table is measured at points that cannot be relied on.
bool is_unsure(const NamedCurve& one, const Quantity& quantity) {
  if (one.way.curve != &LoopAnalysis::measured || !quantity.at_rad_s) return false;
  const double at_rad_s = quantity.at_rad_s(one.curve);
  if (!std::isfinite(at_rad_s) || one.curve.points.size() < 2) return false;
  const auto [below, above] = around(one.curve.points, at_rad_s);
  return !is_reliable(below) || !is_reliable(above);
}

// Why a measured margin is far from the designed one; empty where it is not.
std::string reason_of_difference(const LoopAnalysis& loop) {
  constexpr double kFar_dB = 3.0, kWide = 1.6;
  if (loop.designed.points.empty() || loop.measured.points.empty()) return "";
  const LoopMargins &designed = loop.designed.margins, &measured = loop.measured.margins;
  const double a = in_dB(designed.gain_margin), b = in_dB(measured.gain_margin);
  if (!(std::abs(a - b) > kFar_dB)) return "";
  const auto [below, above] = around(loop.measured.points, measured.gain_margin_rad_s);
  const double low = below.omega_rad_s, high = above.omega_rad_s;
  std::string why =
      "The design leaves out encoder, limits and friction, and these change the loop there";
  if (!is_reliable(above) || !is_reliable(below)) {
    why =
        "A dot there is not reliable (grey), because the probe moves the encoder by too few "
        "counts. "
        "Trust the designed margin, or probe with a larger --amplitude";
  } else if (high > kWide * low) {
    why = "The points are far apart there: --points tells more";
  }
  return fmt::format(
      "{}: the gain margin is {:.1f} dB as designed and {:.1f} dB as measured. The measured phase "
      "crossover is between the measured frequencies {:.4g} and {:.4g} rad/s. {}.",
      loop.name.label(), a, b, low, high, why);
}

BodeCurve curve_of(const LoopAnalysis& loop, const LoopCurve& curve, const Response& response) {
  BodeCurve result;
  if (!loop.estimates && response.needs_estimator) return result;
  for (const LoopPoint& point : curve.points) {
    result.omega_rad_s.push_back(point.omega_rad_s);
    result.gain.push_back(point.*response.value);
    result.is_unsure.push_back(!is_reliable(point));
  }
  return result;
}

// One column per loop and way. Numbers beside a grey dot are marked.
PageData margins_of(const std::vector<LoopAnalysis>& loops) {
  const std::vector<NamedCurve> curves = curves_of(loops);
  PageData table = {
      {"label", "Margins"}, {"columns", PageData::array({""})}, {"rows", PageData::array()}};
  for (const NamedCurve& one : curves) {
    table["columns"].push_back(one.loop.name.label() +
                               (one.way.curve == &LoopAnalysis::measured ? " measured" : ""));
  }
  for (const Quantity& quantity : quantities()) {
    PageData row = {quantity.words};
    for (const NamedCurve& one : curves) {
      const double value = quantity.of(one.curve);
      row.push_back(is_unsure(one, quantity)
                        ? PageData{{"value", value},
                                   {"tone", "unsure"},
                                   {"tip", "not reliable: measured beside a grey dot"}}
                        : PageData(value));
    }
    table["rows"].push_back(row);
  }
  return table;
}

// The result of the command: what its page shows.
PageData result_of(const std::vector<LoopAnalysis>& loops, const std::string& scenario,
                   const std::vector<std::string>& cases, const std::string& command,
                   const AxisUnits& units) {
  std::vector<std::string> names;
  for (const LoopAnalysis& loop : loops) names.push_back(loop.name.label());
  const std::vector<Identity> looks = candidate_identities(names, cases);
  auto lead = PageData::array();
  lead.push_back({{"text",
                   "Lines are designed: the controller and its estimator with the linear plant. "
                   "Dots are measured: one sine after another in the simulation, with encoder, "
                   "drive and friction. Grey dots are not reliable."}});
  auto legend = PageData::array();
  for (std::size_t i = 0; i < loops.size(); ++i) {
    legend.push_back({{"entry", names[i]}, {"look", series_class(looks[i])}});
    for (const std::string& note : notes(loops[i])) {
      lead.push_back({{"text", fmt::format("{}: {}.", names[i], note)}});
    }
    lead.push_back({{"text", reason_of_difference(loops[i])}});
  }
  lead.push_back({{"command", command}});
  lead.push_back({{"legend", {{"entries", legend}}}});
  auto sections = PageData::array();
  sections.push_back(
      {{"id", "margins"},
       {"heading", "Margins"},
       {"blocks",
        {{{"table", margins_of(loops)}},
         {{"text",
           "The loop is opened at the plant’s input. The gain may fall by the reduction margin. "
           "Grey numbers are not reliable: they are measured beside a grey dot."}}}}});
  auto figures = PageData::array();
  for (const Response& response : responses(units)) {
    std::vector<BodeLoop> drawn;
    for (const LoopAnalysis& loop : loops) {
      drawn.push_back({loop.name.label(), looks[drawn.size()],
                       curve_of(loop, loop.designed, response),
                       curve_of(loop, loop.measured, response)});
      if (response.value == &LoopPoint::loop_gain && !loop.designed.points.empty()) {
        drawn.back().margins = loop.designed.margins;
      }
    }
    const PageData charts = bode_charts(anchor(response.name), response.unit, drawn);
    if (charts.empty()) continue;
    figures.push_back({{"caption", response.title}, {"charts", charts}, {"note", response.about}});
  }
  sections.push_back(
      {{"id", "responses"}, {"heading", "Responses"}, {"blocks", {{{"figures", figures}}}}});
  return {{"title", "Frequency response of " + scenario}, {"lead", lead}, {"sections", sections}};
}

}  // namespace

std::vector<std::string> notes(const LoopAnalysis& loop) {
  std::vector<std::string> texts;
  const std::string& reason = loop.designed.reason;
  if (loop.designed.is_unstable) {
    texts.push_back("the loop is not stable: " + reason + ". It has no margins");
  } else if (!reason.empty()) {
    texts.push_back("only measured, because the loop is not linear: " + reason);
  }
  texts.insert(texts.end(), loop.hints.begin(), loop.hints.end());
  return texts;
}

std::string margins_table(const std::vector<LoopAnalysis>& loops, std::size_t width) {
  return printed_table(margins_of(loops), width);
}

void write_analysis(const std::vector<LoopAnalysis>& loops, const std::string& scenario,
                    const std::vector<std::string>& cases, const std::string& command,
                    const AxisUnits& units, const fs::path& folder) {
  const std::string html = html_page("analysis", result_of(loops, scenario, cases, command, units));
  fs::create_directories(folder);
  replace_file(folder / "analysis.csv", points_csv(loops, responses(units)));
  replace_file(folder / "margins.csv", margins_csv(loops));
  replace_file(folder / "report.html", html);
}

}  // namespace breakwater
