#include <breakwater/analysis/analysis_outputs.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>

#include <breakwater/config/config.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/sim/model.h>
#include <breakwater/study/study.h>

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

namespace fs = std::filesystem;
namespace {

struct Arguments {
  std::string scenario;
  std::vector<std::string> cases;
  std::string axis;
  std::string config;
  std::vector<std::string> sets;
  std::string out;
  bool is_design_only = false;
  bool quiet = false;
  AnalysisOptions options;
};

void describe(CLI::App& app, Arguments& arguments) {
  AnalysisOptions& options = arguments.options;
  app.add_option("SCENARIO", arguments.scenario,
                 "a scenario of axes: a motor, a cart, a plant, or your own; or a scenario file")
      ->required();
  app.add_option("--case", arguments.cases,
                 "cases to compare in one chart, or all (default: the file's)")
      ->type_name("NAME[,NAME...]");
  app.add_option("--axis", arguments.axis,
                 "axis of a plant, under its own controller (default: all driven axes,\n"
                 "each as a loop while the others hold the pose)")
      ->type_name("NAME");
  app.add_option("--config", arguments.config, "use another scenario file")->type_name("FILE");
  app.add_option("--set", arguments.sets, "override keys of all cases")->type_name("KEY=VALUE");
  app.add_option("--out", arguments.out, "folder of the result (default: runs/analyze/SCENARIO)")
      ->type_name("DIR");
  app.add_option("--from", options.from_rad_s, "lowest frequency [rad/s] (default: 0.1)")
      ->type_name("OMEGA")
      ->check(CLI::PositiveNumber);
  app.add_option("--to", options.to_rad_s,
                 "highest frequency [rad/s] (default: 0.9 of the Nyquist frequency)")
      ->type_name("OMEGA")
      ->check(CLI::PositiveNumber);
  app.add_option("--points", options.points, "number of measured frequencies (default: 25)")
      ->type_name("N")
      ->check(CLI::Range(2, 10000));
  app.add_option("--amplitude", options.force_amplitude,
                 "amplitude of the sine at the drive [N m or N] (default: 1, but at most\n"
                 "a tenth of the drive's limit)")
      ->type_name("F")
      ->check(CLI::PositiveNumber);
  app.add_option("--noise-amplitude", options.noise_amplitude,
                 "amplitude of the sine at the sensor [rad or m] (default: three of the\n"
                 "encoder's counts, or 1e-3)")
      ->type_name("X")
      ->check(CLI::PositiveNumber);
  app.add_option("--settle", options.settle_s, "time before the measurement [s] (default: 5)")
      ->type_name("S")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--jobs", options.jobs, "how many runs at a time (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  app.add_flag("--design-only", arguments.is_design_only, "measure nothing");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  add_digits(app);
  app.footer(
      "Designed: the controller and its estimator with the linear plant, if they are linear.\n"
      "Measured: one sine after another in the simulation, with the case's encoder, drive and\n"
      "friction. A loop that is not linear is measured at the frequency of the sine only.\n"
      "Writes report.html, margins.csv and analysis.csv.\n"
      "Exit status: 0 success, 1 a defect, 2 usage or input, 3 a run failed, 130 interrupted.");
}

std::vector<std::string> cases_of(const Arguments& arguments, const ScenarioFile& file) {
  std::vector<std::string> names;
  for (const std::string& option : arguments.cases) {
    for (const std::string& name : option_parts(option)) names.push_back(name);
  }
  if (names.empty()) return {file.default_case()};
  if (names == std::vector<std::string>{"all"}) return file.cases();
  return names;
}

// The loops of a case. A plant with several gives each the name of its axis.
void add_loops(const PreparedRun& run, const Arguments& arguments,
               std::vector<AnalysedLoop>& loops) {
  std::vector<std::string> names;
  const std::size_t before = loops.size();
  for (AxisOfPlant& axis : dynamic_cast<const AxisScenario&>(*run.scenario).loops()) {
    const std::string& name = names.emplace_back(axis.settings().axis.name);
    if (!arguments.axis.empty() && arguments.axis != name) continue;
    loops.push_back({{run.case_name}, std::move(axis)});
  }
  if (names.empty()) {
    throw std::invalid_argument(run.case_name + ": no driven axis has a controller");
  }
  if (loops.size() == before) {
    throw std::invalid_argument(
        fmt::format("--axis: there is no driven axis \"{}\" with a controller{}", arguments.axis,
                    did_you_mean(arguments.axis, names)));
  }
  if (names.size() == 1) return;
  for (std::size_t i = before; i < loops.size(); ++i) {
    const Axis& axis = loops[i].axis.settings().axis;
    loops[i].name.axis = axis.name;
    if (axis.units.position != loops[before].axis.settings().axis.units.position) {
      throw std::invalid_argument("--axis: is needed, because the axes have different units");
    }
  }
}

int analyze(const Catalogue& catalogue, Arguments arguments, const std::string& command) {
  stop_on_signals();
  const SharedModels shared;  // one compilation for all frequencies
  if (is_scenario_file(arguments.scenario)) {
    if (!arguments.config.empty()) {
      throw std::invalid_argument("--config: SCENARIO is a scenario file already");
    }
    arguments.config = std::exchange(arguments.scenario, scenario_name_in(arguments.scenario));
  }
  const auto& kind = catalogue.get<ScenarioKind>(arguments.scenario);
  if (dynamic_cast<const AxisScenario*>(kind.make(catalogue).get()) == nullptr) {
    throw std::invalid_argument(kind.name +
                                ": expected a scenario of axes (a scenario of your own must be an "
                                "AxisScenario)");
  }
  const auto read = kind.scenario_file(arguments.config);
  const ScenarioFile& file = *read;
  std::vector<PreparedRun> prepared;
  std::vector<AnalysedLoop> loops;
  for (const std::string& name : cases_of(arguments, file)) {
    prepared.push_back(prepare_run(catalogue, kind.name, file, name, arguments.sets));
    add_loops(prepared.back(), arguments, loops);
  }
  arguments.options.stop = &interrupted();
  arguments.options.quiet = arguments.quiet;
  if (arguments.is_design_only) arguments.options.points = 0;

  std::vector<LoopAnalysis> results;
  try {
    results = analyse(loops, arguments.options);
  } catch (const RunFailure& failure) {
    fmt::print(stderr, "{}: failed at t = {:.6g} s: {}\n", kind.name, failure.time_s(),
               one_line(failure.what()));
    return kRunFailed;
  } catch (const ControlFailure& failure) {
    fmt::print(stderr, "{}: failed: {}\n", kind.name, one_line(failure.what()));
    return kRunFailed;
  }
  for (const LoopAnalysis& loop : results) {
    if (arguments.quiet && !loop.designed.is_unstable) continue;
    for (const std::string& note : notes(loop)) {
      fmt::print(stderr, "{} {}: {}\n", kind.name, loop.name.label(), note);
    }
  }
  const auto is_unstable = [](const LoopAnalysis& loop) { return loop.designed.is_unstable; };
  if (std::all_of(results.begin(), results.end(), is_unstable)) return kRunFailed;
  const fs::path folder =
      arguments.out.empty() ? fs::path("runs") / kAnalyze / kind.name : fs::path(arguments.out);
  write_analysis(results, kind.name, file.cases(), command,
                 loops.front().axis.settings().axis.units, folder);
  if (arguments.quiet) return kSuccess;
  fmt::print("results: {}\n\n{}", folder.string(), margins_table(results, output_width()));
  return kSuccess;
}

}  // namespace

int analyze_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " " + kAnalyze;
  return guarded(program, [&] {
    CLI::App app("Compute frequency responses of loops of one axis, designed and measured.",
                 program);
    Arguments arguments;
    describe(app, arguments);
    if (const auto status = parse(app, argc, argv)) return *status;
    std::string command = own_program_name();
    for (int i = 0; i < argc; ++i) command += " " + shell_word(argv[i]);
    return analyze(catalogue, arguments, command);
  });
}

}  // namespace breakwater
