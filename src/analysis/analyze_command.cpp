#include <breakwater/analysis/analyze_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include <breakwater/analysis/analysis_outputs.h>
#include <breakwater/config/scenario_name.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/sim/model.h>
#include <breakwater/study/study.h>

namespace breakwater {
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
  for (AxisOfPlant& axis : dynamic_cast<const LoopScenario&>(*run.scenario).loops()) {
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
  if (dynamic_cast<const LoopScenario*>(kind.make(catalogue).get()) == nullptr) {
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
