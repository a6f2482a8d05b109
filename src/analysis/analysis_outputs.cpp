#include <breakwater/analysis/analysis_outputs.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <utility>

#include <breakwater/config/config.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/sim/model.h>
#include <breakwater/study/result_row.h>

namespace breakwater {

namespace fs = std::filesystem;

namespace {

constexpr double kInDegrees = 180.0 / std::numbers::pi;
constexpr double kDeep_dB = 120.0, kLow_dB = -60.0;  // values below both limits are not drawn

double in_dB(double gain) {
  return 20.0 * std::log10(gain);
}

std::vector<BodeResponse> responses(const AxisUnits& units) {
  return {
      {"d_hat_over_d", &LoopPoint::d_hat_over_d, true, "From the disturbance to its estimate",
       "0 dB means that the estimate equals the disturbance. The loop is closed.", ""},
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
       "The loop is opened at the plant’s input.", ""}};
}

// An existing curve of a loop, designed or measured.
struct NamedCurve {
  const LoopAnalysis& loop;
  bool is_measured;
  const LoopCurve& curve;

  const char* way() const { return is_measured ? "measured" : "designed"; }
};

std::vector<NamedCurve> curves_of(const std::vector<LoopAnalysis>& loops) {
  std::vector<NamedCurve> curves;
  for (const LoopAnalysis& loop : loops) {
    if (!loop.designed.points.empty()) curves.push_back({loop, false, loop.designed});
    if (!loop.measured.points.empty()) curves.push_back({loop, true, loop.measured});
  }
  return curves;
}

struct Quantity {
  const char* column;
  const char* words;
  double (*of)(const LoopCurve&);
};

constexpr std::array<Quantity, 8> kQuantities = {
    {{"bandwidth_rad_s", "bandwidth of d_hat/d, −3 dB [rad/s]",
      [](const LoopCurve& c) { return c.bandwidth_rad_s; }},
     {"crossover_rad_s", "crossover |L| = 1 [rad/s]",
      [](const LoopCurve& c) { return c.margins.crossover_rad_s; }},
     {"phase_margin_deg", "phase margin [deg]",
      [](const LoopCurve& c) { return c.margins.phase_margin_rad * kInDegrees; }},
     {"gain_margin_dB", "gain margin [dB]",
      [](const LoopCurve& c) { return in_dB(c.margins.gain_margin); }},
     {"gain_reduction_margin_dB", "gain reduction margin [dB]",
      [](const LoopCurve& c) { return in_dB(c.margins.gain_reduction_margin); }},
     {"delay_margin_ms", "delay margin [ms]",
      [](const LoopCurve& c) { return 1e3 * c.margins.delay_margin_s; }},
     {"sensitivity_peak_1", "M_s, largest sensitivity",
      [](const LoopCurve& c) { return c.margins.sensitivity_peak; }},
     {"complementary_peak_1", "M_t, largest complementary sensitivity",
      [](const LoopCurve& c) { return c.margins.complementary_peak; }}}};

// The first cells of a row of a CSV file.
ResultRow begun_row(const NamedCurve& one) {
  ResultRow row;
  row.put("case", one.loop.name.case_name);
  row.put("axis", one.loop.name.axis);
  row.put("way", one.way());
  return row;
}

std::string points_csv(const std::vector<LoopAnalysis>& loops,
                       const std::vector<BodeResponse>& all) {
  std::vector<ResultRow> rows;
  for (const NamedCurve& one : curves_of(loops)) {
    for (const LoopPoint& point : one.curve.points) {
      ResultRow& row = rows.emplace_back(begun_row(one));
      row.put("omega_rad_s", point.omega_rad_s);
      for (const BodeResponse& response : all) {
        const bool is_there = one.loop.estimates || !response.needs_estimator;
        const std::complex<double> value = is_there ? point.*response.value : std::nan("");
        row.put(response.name + std::string("_gain"), std::abs(value));
        row.put(response.name + std::string("_phase_deg"), std::arg(value) * kInDegrees);
      }
      row.put("spread_1", point.spread);
      row.put("saturated_1", point.saturated);
    }
  }
  return csv_table(rows);
}

std::string margins_csv(const std::vector<LoopAnalysis>& loops) {
  std::vector<ResultRow> rows;
  for (const NamedCurve& one : curves_of(loops)) {
    ResultRow& row = rows.emplace_back(begun_row(one));
    for (const Quantity& quantity : kQuantities) row.put(quantity.column, quantity.of(one.curve));
  }
  return csv_table(rows);
}

double nearest_turn(double phase, double to) {
  return phase + 360.0 * std::round((to - phase) / 360.0);
}

// The value of a line at log10 of a frequency, or at the next one that it has.
double at(const Series& line, double x) {
  const auto next = std::ranges::lower_bound(line.times_s, x) - line.times_s.begin();
  return line.values[std::min(static_cast<std::size_t>(next), line.values.size() - 1)];
}

// One column per loop and way.
PageData margins_of(const std::vector<LoopAnalysis>& loops) {
  const std::vector<NamedCurve> curves = curves_of(loops);
  PageData table = {
      {"label", "Margins"}, {"columns", PageData::array({""})}, {"rows", PageData::array()}};
  for (const NamedCurve& one : curves) {
    table["columns"].push_back(one.loop.name.label() + ' ' + one.way());
  }
  for (const Quantity& quantity : kQuantities) {
    PageData row = {quantity.words};
    for (const NamedCurve& one : curves) row.push_back(quantity.of(one.curve));
    table["rows"].push_back(row);
  }
  return table;
}

// Says why a loop has no designed curve (it is not stable, or not linear), then its hints.
std::vector<std::string> notes(const LoopAnalysis& loop) {
  std::vector<std::string> texts;
  const std::string& reason = loop.designed.reason;
  if (loop.designed.is_unstable) {
    texts.push_back("the loop is not stable: " + reason + ". It has no margins");
  } else if (!reason.empty()) {
    texts.push_back("only measured, because the loop is not linear with constant coefficients: " +
                    reason);
  }
  texts.insert(texts.end(), loop.hints.begin(), loop.hints.end());
  return texts;
}

// The result of the command: what its page shows.
PageData result_of(const std::vector<LoopAnalysis>& loops, const std::string& scenario,
                   const std::vector<std::string>& cases, const std::string& command,
                   const std::vector<BodeResponse>& responses) {
  std::vector<std::string> names;
  for (const LoopAnalysis& loop : loops) names.push_back(loop.name.label());
  const std::vector<LineStyle> looks = candidate_styles(names, cases);
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
  }
  lead.push_back({{"command", command}});
  lead.push_back({{"legend", {{"entries", legend}}}});
  auto sections = PageData::array(), figures = PageData::array();
  add_section(sections, "margins", "Margins",
              {{{"table", margins_of(loops)}},
               {{"text",
                 "The loop is opened at the plant’s input. The gain may fall by the reduction "
                 "margin. Grey dots do not count in measured margins."}}});
  for (const BodeResponse& response : responses) {
    const PageData charts = bode_charts(response, loops, looks);
    if (charts.empty()) continue;
    figures.push_back({{"caption", response.title}, {"charts", charts}, {"note", response.about}});
  }
  add_section(sections, "responses", "Responses", PageData::array({{{"figures", figures}}}));
  return {{"title", "Frequency response of " + scenario}, {"lead", lead}, {"sections", sections}};
}

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
      ->type_name("NAME[,NAME...]")
      ->delimiter(',');
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
      ->check(must_be_positive);
  app.add_option("--to", options.to_rad_s,
                 "highest frequency [rad/s] (default: 0.9 of the Nyquist frequency)")
      ->type_name("OMEGA")
      ->check(must_be_positive);
  app.add_option("--points", options.points, "number of measured frequencies (default: 25)")
      ->type_name("N")
      ->check(CLI::Range(2, 10000));
  app.add_option("--amplitude", options.force_amplitude,
                 "amplitude of the sine at the drive [N m or N] (default: 1, but at most\n"
                 "a tenth of the drive's limit)")
      ->type_name("F")
      ->check(must_be_positive);
  app.add_option("--noise-amplitude", options.noise_amplitude,
                 "amplitude of the sine at the sensor [rad or m] (default: three of the\n"
                 "encoder's counts, or 1e-3)")
      ->type_name("X")
      ->check(must_be_positive);
  app.add_option("--settle", options.settle_s, "time before the measurement [s] (default: 5)")
      ->type_name("S")
      ->check(must_be_0_or_more);
  app.add_option("--jobs", options.jobs, "how many runs at a time (default: all cores)")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  app.add_flag("--design-only", arguments.is_design_only, "measure nothing");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  app.footer(
      "Designed: the controller and its estimator with the linear plant, if they are linear.\n"
      "Measured: one sine after another in the simulation, with the case's encoder, drive and\n"
      "friction. A loop that is not linear is measured at the frequency of the sine only.\n"
      "Writes report.html, margins.csv and analysis.csv.\n"
      "Exit status: 0 success, 1 a defect, 2 usage or input, 3 a run failed, 130 interrupted.");
}

std::vector<std::string> cases_of(const Arguments& arguments, const ScenarioFile& file) {
  if (arguments.cases.empty()) return {file.default_case()};
  return arguments.cases == std::vector<std::string>{"all"} ? file.cases() : arguments.cases;
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
    if (names.front().empty()) {
      throw std::invalid_argument("--axis: the scenario has a single axis: leave --axis out");
    }
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
    arguments.config =
        std::exchange(arguments.scenario, scenario_name_in(catalogue, arguments.scenario));
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
  const std::vector<BodeResponse> all = responses(loops.front().axis.settings().axis.units);
  const std::string html =
      html_page("analysis", result_of(results, kind.name, file.cases(), command, all));
  fs::create_directories(folder);
  replace_file(folder / "analysis.csv", points_csv(results, all));
  replace_file(folder / "margins.csv", margins_csv(results));
  replace_file(folder / "report.html", html);
  if (arguments.quiet) return kSuccess;
  fmt::print("results: {}\n\n{}", folder.string(),
             printed_table(margins_of(results), output_width()));
  return kSuccess;
}

}  // namespace

PageData bode_charts(const BodeResponse& response, const std::vector<LoopAnalysis>& loops,
                     const std::vector<LineStyle>& looks) {
  const std::string id = anchor(response.name);
  PageChart gain{.id = id + "-gain", .group = id, .x_title = "frequency [rad/s]", .is_log_x = true};
  PageChart phase = gain;
  gain.title = response.unit.empty() ? "gain [dB]" : "gain [dB of " + response.unit + "]";
  phase.id = id + "-phase";
  phase.title = "phase [deg]";
  double highest = -kDeep_dB;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const LoopAnalysis& loop = loops[i];
    if (!loop.estimates && response.needs_estimator) continue;
    const auto series = [&](const char* what, LineStyle look, const char* marks) {
      return ChartSeries{.label = loop.name.label() + what,
                         .style = look,
                         .has_line = *marks == '\0',
                         .marks = marks};
    };
    // The designed line, and the measured marks; those that are not sure are grey.
    ChartSeries gains[] = {series("", looks[i], ""), series(", measured", looks[i], "dot"),
                           series(", not reliable", kReferenceStyle, "dot")};
    ChartSeries phases[] = {gains[0], gains[1], gains[2]};
    Series& line = phases[0].values;
    double last = 0.0;  // the first phase is within ±180
    for (const LoopCurve* curve : {&loop.designed, &loop.measured}) {
      for (const LoopPoint& point : curve->points) {
        const std::complex<double> value = point.*response.value;
        const double x = std::log10(point.omega_rad_s), dB = in_dB(std::abs(value));
        const std::size_t kind = curve == &loop.designed ? 0 : is_reliable(point) ? 1 : 2;
        // Marks beside a line are too far apart to be unwrapped alone.
        if (kind > 0 && !line.values.empty()) last = at(line, x);
        last = nearest_turn(std::arg(value) * kInDegrees, last);
        gains[kind].values.times_s.push_back(x);
        gains[kind].values.values.push_back(dB);
        phases[kind].values.times_s.push_back(x);
        phases[kind].values.values.push_back(last);
        if (kind < 2) highest = std::max(highest, dB);
      }
    }
    for (auto [from, to] : {std::pair(gains, &gain), std::pair(phases, &phase)}) {
      std::copy_if(from, from + 3, std::back_inserter(to->series),
                   [](const ChartSeries& one) { return !one.values.values.empty(); });
    }
  }
  if (gain.series.empty()) return PageData::array();
  // A line that is too low to be drawn has a gap, and no mark.
  const double lowest = std::min(highest - kDeep_dB, kLow_dB);
  for (ChartSeries& one : gain.series) {
    for (double& value : one.values.values) value = value < lowest ? std::nan("") : value;
  }
  return {gain.json(), phase.json()};
}

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
