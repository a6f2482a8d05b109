#include <breakwater/analysis/analyze_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include <breakwater/analysis/analysis_outputs.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/shell/child_program.h>
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
                 "a scenario with one axis: a motor, a cart, or your own")
      ->required();
  app.add_option("--case", arguments.cases,
                 "cases to compare in one chart, or all (default: the file's)")
      ->type_name("NAME[,NAME...]");
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
                 "amplitude of the sine at the drive [N m or N] (default: 1)")
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

int analyze(const Catalogue& catalogue, Arguments arguments, const std::string& command) {
  stop_on_signals();
  const SharedModels shared;  // one compilation for all frequencies
  const auto& kind = catalogue.get<ScenarioKind>(arguments.scenario);
  if (dynamic_cast<const AxisScenario*>(kind.make(catalogue).get()) == nullptr) {
    throw std::invalid_argument(kind.name +
                                ": expected a scenario with one axis (a scenario of "
                                "your own must be an AxisScenario)");
  }
  const ScenarioFile file(arguments.config.empty() ? kind.file().string() : arguments.config,
                          kind.name);
  std::vector<PreparedRun> prepared;
  std::vector<AnalysedLoop> loops;
  for (const std::string& name : cases_of(arguments, file)) {
    prepared.push_back(prepare_run(catalogue, kind.name, file, name, arguments.sets));
    loops.push_back({name, dynamic_cast<const AxisScenario*>(prepared.back().scenario.get())});
  }
  arguments.options.stop = &interrupted();
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
    if (loop.designed.reason.empty() || (arguments.quiet && !loop.designed.is_unstable)) continue;
    fmt::print(stderr, "{} {}: {}\n", kind.name, loop.label, why_not_designed(loop.designed));
  }
  const auto is_unstable = [](const LoopAnalysis& loop) { return loop.designed.is_unstable; };
  if (std::all_of(results.begin(), results.end(), is_unstable)) return kRunFailed;
  const fs::path folder =
      arguments.out.empty() ? fs::path("runs") / kAnalyze / kind.name : fs::path(arguments.out);
  write_analysis(results, kind.name, file.cases(), command,
                 loops.front().scenario->plant().axis().axis.units, folder);
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
