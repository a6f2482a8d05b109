#include "scenario/command_line.h"

#include <fmt/core.h>
#include <csignal>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "record/output_error.h"
#include "record/run_folder.h"
#include "scenario/progress.h"
#include "scenario/report.h"
#include "scenario/runner.h"
#include "scenario/waves_report.h"
#include "version.h"

namespace breakwater {
namespace fs = std::filesystem;
namespace {

enum Status { kSuccess = 0, kDefect = 1, kUsage = 2, kRunFailed = 3, kInterrupted = 130 };

constexpr const char* kAll = "all";

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

void stop_on_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int) { interrupted = true; };
  action.sa_flags = SA_RESETHAND;  // a second one ends the process at once
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

struct Arguments {
  std::string case_name;
  std::string config;
  std::vector<std::string> sets;
  std::string seed;
  std::string duration;
  std::string out;
  bool csv = false;
  bool quiet = false;
  bool list_cases = false;
  bool print_config = false;
};

void describe(CLI::App& app, Arguments& arguments) {
  app.add_option("--case", arguments.case_name,
                 "which case to run (--list-cases), or all: every case, on all cores")
      ->type_name("NAME");
  app.add_option("--config", arguments.config,
                 "another scenario file, such as a run's own config.toml")
      ->type_name("FILE");
  app.add_option("--set", arguments.sets,
                 "override keys of the scenario file (--print-config shows them all)")
      ->type_name("KEY=VALUE");
  app.add_option("--seed", arguments.seed, "the same as --set run.seed=N")->type_name("N");
  app.add_option("--duration", arguments.duration, "the same as --set run.duration_s=S")
      ->type_name("S");
  app.add_option("--out", arguments.out,
                 "the run's folder; with --case all, the folder of the runs' folders\n"
                 "(default: runs/SCENARIO/CASE-seedN)")
      ->type_name("DIR");
  app.add_flag("--csv", arguments.csv, "write log.csv as well");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  app.add_flag("--list-cases", arguments.list_cases, "print the cases, one a line, and exit");
  app.add_flag("--print-config", arguments.print_config,
               "print the effective configuration, as a scenario file, and exit");
  app.set_version_flag("--version", std::string(kVersion) + " (" + kGitCommit + ")");
  app.footer(
      "A run leaves a folder with config.toml, metrics.json, manifest.json and log.h5.\n"
      "Exit status: 0 success, 1 a defect, 2 usage or input, 3 the run failed, 4 only a later\n"
      "output failed, 130 interrupted.");
}

std::vector<std::string> all_sets(const Arguments& arguments) {
  std::vector<std::string> sets = arguments.sets;
  if (!arguments.seed.empty()) sets.push_back("run.seed=" + arguments.seed);
  if (!arguments.duration.empty()) sets.push_back("run.duration_s=" + arguments.duration);
  return sets;
}

// Refuses a folder for the folders of several runs that holds anything else.
void check_folder_of_runs(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) {
    throw std::invalid_argument(folder.string() + ": is a file, not a folder");
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    const bool is_partial = entry.path().filename().string().starts_with(".");
    if (!is_partial && !is_run_folder(entry.path())) {
      throw std::invalid_argument(folder.string() +
                                  ": holds something that is not a run; it is left alone");
    }
  }
}

void report_failures(const std::string& scenario, const std::vector<RunSummary>& runs) {
  for (const RunSummary& run : runs) {
    if (!run.failure) continue;
    fmt::print(stderr, "{} {}: failed at t = {:.6g} s: {}; its log is in {}\n", scenario,
               run.case_name, run.failure->time_s, run.failure->reason, run.folder.string());
  }
}

void print_warnings(const std::string& scenario, const std::vector<PreparedRun>& runs) {
  for (const PreparedRun& run : runs) {
    for (const std::string& warning : run.scenario->warnings()) {
      fmt::print(stderr, "{} {}: warning: {}\n", scenario, run.case_name, warning);
    }
  }
}

int run_cases(const std::string& scenario, const ScenarioFile& file, const Arguments& arguments) {
  const bool all = arguments.case_name == kAll;
  const std::string case_name =
      arguments.case_name.empty() ? file.default_case() : arguments.case_name;
  const std::vector<std::string> cases = all ? file.cases() : std::vector{case_name};

  std::vector<PreparedRun> runs;
  for (const std::string& name : cases) {
    runs.push_back(prepare_run(scenario, file, name, all_sets(arguments)));
  }
  if (arguments.print_config) {
    for (const PreparedRun& run : runs) fmt::print("{}", run.config_text);
    return kSuccess;
  }

  const std::uint64_t seed = runs.front().scenario->run_settings().seed;
  const fs::path out = arguments.out.empty()
                           ? fs::path("runs") / scenario / fmt::format("{}-seed{}", case_name, seed)
                           : fs::path(arguments.out);
  std::vector<fs::path> folders;
  if (all) check_folder_of_runs(out);
  for (const std::string& name : cases) folders.push_back(all ? out / name : out);

  if (!arguments.quiet) print_warnings(scenario, runs);
  stop_on_signals();
  const std::vector<RunSummary> summaries =
      execute_runs(runs, folders, {arguments.csv, arguments.quiet, &interrupted});

  report_failures(scenario, summaries);
  const bool failed = std::any_of(summaries.begin(), summaries.end(),
                                  [](const RunSummary& run) { return run.failure.has_value(); });
  if (!arguments.quiet) {
    if (all) {
      fmt::print("results: {}\n\n{}", out.string(),
                 comparison_table(scenario, summaries, output_width()));
    } else if (!failed) {
      const RunSummary& run = summaries.front();
      fmt::print("{} {}: {:.6g} s simulated in {:.1f} s\nresults: {}\n\n{}", scenario,
                 run.case_name, run.simulated_s, run.wall_s, out.string(),
                 metrics_table(scenario, run));
    }
  }
  return failed ? kRunFailed : kSuccess;
}

// Everything that can go wrong becomes one line and a status.
template <typename Body>
int guarded(const std::string& program, Body&& body) {
  try {
    return body();
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kUsage;
  } catch (const OutputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return kUsage;
  } catch (const Interrupted&) {
    fmt::print(stderr, "{}: interrupted; nothing is left behind\n", program);
    return kInterrupted;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: this is a defect of Breakwater: {}\n", program, error.what());
    return kDefect;
  }
}

// Returns the status to exit with, or nothing if the arguments were taken.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app.help());
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "{}: {} (see --help)\n", app.get_name(), error.what());
    return kUsage;
  }
  return kSuccess;
}

}  // namespace

int scenario_main(const std::string& scenario, int argc, const char* const* argv) {
  return guarded(scenario, [&] {
    CLI::App app(scenario + ": " + make_scenario(scenario)->summary(), scenario);
    Arguments arguments;
    describe(app, arguments);
    if (const auto status = parse(app, argc, argv)) return *status;

    const std::string path =
        arguments.config.empty() ? scenario_file(scenario).string() : arguments.config;
    const ScenarioFile file(path, scenario);
    if (arguments.list_cases) {
      for (const std::string& name : file.cases()) fmt::print("{}\n", name);
      return static_cast<int>(kSuccess);
    }
    return run_cases(scenario, file, arguments);
  });
}

int breakwater_main(int argc, const char* const* argv) {
  if (argc >= 3 && std::string(argv[1]) == "run") {
    return guarded("breakwater", [&] {
      const std::string scenario = make_scenario(argv[2])->name();
      return scenario_main(scenario, argc - 2, argv + 2);
    });
  }
  return guarded("breakwater", [&] {
    CLI::App app("Breakwater: a testbed for robust model-based motion control.", "breakwater");
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string(kVersion) + " (" + kGitCommit + ")");
    const CLI::App* list = app.add_subcommand("list", "print the scenarios and what they study");
    std::string scenario;
    CLI::App* run = app.add_subcommand(
        "run", "run a scenario, the same as its own binary: breakwater run NAME [OPTION...]");
    run->add_option("NAME", scenario, "which scenario (breakwater list)")->required();
    SeaState sea;
    sea.significant_height_m = 2.0;
    CLI::App* waves = app.add_subcommand("waves", "check a sea's spectrum and its water");
    waves->add_option("--height", sea.significant_height_m, "H_s [m]")->capture_default_str();
    waves->add_option("--period", sea.peak_period_s, "T_p [s]")->capture_default_str();
    waves->add_option("--gamma", sea.gamma, "peak enhancement")->capture_default_str();
    waves->add_option("--depth", sea.water_depth_m, "of the bottom; 0: deep water [m]")
        ->capture_default_str();
    waves->add_option("--components", sea.components, "of the realisation")->capture_default_str();
    waves->add_option("--seed", sea.seed, "of the realisation")->capture_default_str();
    if (const auto status = parse(app, argc, argv)) return *status;
    if (waves->parsed()) fmt::print("{}", waves_report(sea));
    if (list->parsed()) {
      for (const std::string& name : scenario_names()) {
        fmt::print("{:<20}{}\n", name, make_scenario(name)->summary());
      }
    }
    return static_cast<int>(kSuccess);
  });
}

}  // namespace breakwater
