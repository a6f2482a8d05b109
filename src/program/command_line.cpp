#include <breakwater/program/command_line.h>

#include <fmt/core.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <ranges>
#include <set>
#include <stdexcept>

#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/run_tables.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/experiment/version.h>
#include <breakwater/program/commands.h>
#include <breakwater/record/run_folder.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/mjcf_conversion.h>

namespace breakwater {
void add_run_changes(CLI::App& app, RunChanges& options, const std::string& config_help,
                     const std::string& set_help, const std::string& group) {
  app.add_option("--config", options.config, config_help)->type_name("FILE")->group(group);
  app.add_option("--set", options.sets, set_help)->type_name("KEY=VALUE")->group(group);
  app.add_option("--duration", options.duration, "the same as --set run.duration_s=S")
      ->type_name("S")
      ->check(must_be_number)
      ->group(group);
}

void add_set(std::vector<std::string>& sets, const std::string& option, const std::string& key,
             const std::string& value) {
  if (value.empty()) return;
  for (const std::string& set : sets) {
    if (!set.starts_with(key + "=")) continue;
    throw std::invalid_argument(option + ": --set gives " + key + " too: leave one out");
  }
  sets.push_back(key + "=" + value);
}

std::vector<std::string> all_sets(const RunChanges& options) {
  std::vector<std::string> sets = options.sets;
  if (options.duration.empty()) return sets;
  add_set(sets, "--duration", "run.duration_s", toml_number(number_in(options.duration).value()));
  return sets;
}

namespace fs = std::filesystem;
namespace {

constexpr const char* kAll = "all";

struct Arguments {
  std::string cases;  // separated by commas
  RunChanges run;
  std::string seed;
  std::string out;
  CLI::Option* video = nullptr;
  std::string video_file;
  bool csv = false;
  bool quiet = false;
  bool list_cases = false;
  bool matrix = false;
  bool print_config = false;
};

void describe(CLI::App& app, const std::string& video_program, Arguments& arguments) {
  app.add_option("--case", arguments.cases,
                 "which case to run (--list-cases); several, or all, run on all cores")
      ->type_name("NAME[,NAME...]");
  add_run_changes(app, arguments.run, "another scenario file, such as a run's own config.toml",
                  "override keys of the scenario file (--print-config shows them all)");
  app.add_option("--seed", arguments.seed, "the same as --set run.seed=N")
      ->type_name("N")
      ->check(must_be_number);
  app.add_option("--out", arguments.out,
                 "the run's folder; of several runs the folder of their folders\n"
                 "(default: runs/SCENARIO/CASE-seedN)")
      ->type_name("DIR");
  arguments.video =
      app.add_option("--video", arguments.video_file,
                     "make a video of the run as well: video.mp4 in its folder, or\n"
                     "this file (" +
                         fs::path(video_program).filename().string() + " video makes one later)")
          ->type_name("FILE")
          ->expected(0, 1);
  app.add_flag("--csv", arguments.csv, "write log.csv as well");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  app.add_flag("--list-cases", arguments.list_cases, "print the cases, one a line, and exit");
  app.add_flag("--matrix", arguments.matrix,
               "run every case under every condition, on all cores, and print one table a metric\n"
               "(scenarios that have conditions)");
  app.add_flag("--print-config", arguments.print_config,
               "print the effective configuration, as a scenario file, and exit");
  app.set_version_flag("--version", std::string(kVersion) + " (" + kGitCommit + ")");
  app.footer("A run leaves a folder with config.toml, metrics.json, manifest.json and log.h5.\n" +
             std::string(kExitStatuses));
}

std::vector<std::string> all_sets(const Arguments& arguments) {
  std::vector<std::string> sets = all_sets(arguments.run);
  add_set(sets, "--seed", "run.seed", arguments.seed);
  return sets;
}

// --seed and --duration set keys. An error message about such a key names the option that the user
// typed. all_sets() ensures that no --set has the same key.
std::string naming_options(const Arguments& arguments, const std::string& what) {
  for (const auto& [option, value, key] :
       {std::tuple("--seed", &arguments.seed, std::string("--set: run.seed")),
        {"--duration", &arguments.run.duration, "--set: run.duration_s"}}) {
    if (!value->empty() && what.starts_with(key + ":")) return option + what.substr(key.size());
  }
  return what;
}

// Refuses a folder with other contents as the parent of the runs' folders.
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

// Says which runs failed, and the warnings of the runs themselves.
void report(const std::string& scenario, const std::vector<RunSummary>& runs, bool quiet) {
  for (const RunSummary& run : runs) {
    const std::string name = fmt::format("{} {}", scenario, run.case_name);
    if (run.failure) {
      fmt::print(stderr, "{}: failed at t = {:.6g} s: {}; its log is in {}\n", name,
                 run.failure->time_s, run.failure->reason, run.folder.string());
    }
    if (!quiet) warn(name, run.warnings);
  }
}

void check_video(bool several, const Arguments& arguments) {
  if (arguments.video->count() == 0) return;
  opengl_asked();  // refuses an unusable setting before the run
  if (several && !arguments.video_file.empty()) {
    throw std::invalid_argument("--video: one file cannot hold the videos of several runs");
  }
}

// Calls `video_program` to make the video of each run, in the file of --video or in its folder. A
// separate process protects the run, and simulations need no OpenGL and no encoder. Returns 0 or
// the exit status of a failed video, which has printed one line.
int make_videos(const std::vector<RunSummary>& runs, const Arguments& arguments,
                const std::string& video_program) {
  if (arguments.video->count() == 0) return kSuccess;
  int status = kSuccess;
  for (const RunSummary& run : runs) {
    const std::string folder = run.folder.string(), what = "video of the run in " + folder;
    if (!fs::exists(video_program)) {
      fmt::print(stderr,
                 "{}: {}, which draws it, is not there (`./dev build` makes it); the run is whole, "
                 "`breakwater video {}` draws it later\n",
                 what, video_program, folder);
      status = kLaterOutputFailed;
      continue;
    }
    std::vector<std::string> words = {video_program, "video", folder};
    if (!arguments.video_file.empty()) words.insert(words.end(), {"--out", arguments.video_file});
    if (arguments.quiet) words.emplace_back("--quiet");
    const int made = call_program(what, words);
    if (made == kInterrupted) return kInterrupted;
    if (made != kSuccess) status = kLaterOutputFailed;
  }
  return status;
}

// Warns once of what all runs share, and of a --set only if it is ineffective in all of them.
void print_warnings(const std::string& scenario, const std::vector<PreparedRun>& runs) {
  std::set<std::string> models;
  for (const PreparedRun& run : runs) models.insert(run.model_files.begin(), run.model_files.end());
  for (const std::string& model : models) warn(scenario, conversion_warnings(model));
  const auto each_warning = [](const PreparedRun& run, const auto& use) {
    for (const IneffectiveKey& one : run.ineffective) {
      const std::string key = one.origin + ": " + one.key;
      use(key, key + ": " + one.reason);
    }
    for (const std::string& warning : run.scenario->warnings()) use(warning, warning);
  };
  std::map<std::string, std::set<const PreparedRun*>> runs_with;
  for (const PreparedRun& run : runs) {
    each_warning(run, [&](const std::string& what, const auto&) { runs_with[what].insert(&run); });
  }
  for (const PreparedRun& run : runs) {
    each_warning(run, [&](const std::string& what, const std::string& text) {
      const bool is_set = what.starts_with(kSetOrigin);
      const bool is_shared = runs_with[what].size() == runs.size() && (runs.size() > 1 || is_set);
      if (is_shared && &run == &runs.front()) warn(scenario, {text});
      if (!is_shared && !is_set) warn(fmt::format("{} {}", scenario, run.case_name), {text});
    });
  }
}

// One call of the program.
struct Call {
  const Catalogue& catalogue;
  const std::string& scenario;
  const ScenarioFile& file;
  const std::string& video_program;
  const Arguments& arguments;
  KnownModels& models;
};

// The matrix of --matrix. Without it, a matrix of one empty value.
Matrix matrix_of(const Call& call) {
  const Arguments& arguments = call.arguments;
  if (!arguments.matrix) return {"", {""}, {}};
  if (arguments.print_config) {
    throw std::invalid_argument("--print-config: prints one case, not all of --matrix");
  }
  Matrix matrix = make_scenario(call.catalogue, call.scenario)->matrix();
  if (matrix.key.empty()) {
    throw std::invalid_argument(call.scenario + ": --matrix: this scenario has no conditions");
  }
  if (!arguments.cases.empty()) {
    throw std::invalid_argument(call.scenario + ": --matrix: runs all cases, so leave --case out");
  }
  for (const std::string& set : arguments.run.sets) {
    if (!set.starts_with(matrix.key + "=")) continue;
    throw std::invalid_argument(call.scenario + ": --matrix: runs all of " + matrix.key +
                                ", so leave it out of --set");
  }
  return matrix;
}

// The names in --case.
std::vector<std::string> cases_of(const Call& call) {
  if (call.arguments.matrix || call.arguments.cases == kAll) return call.file.cases();
  std::vector<std::string> cases;
  for (const auto part : std::views::split(call.arguments.cases, ',')) {
    cases.emplace_back(part.begin(), part.end());
  }
  if (cases.empty()) return {call.file.default_case()};
  for (const std::string& name : cases) {
    if (name == kAll) throw std::invalid_argument("--case: all stands alone");
    if (name.empty()) throw std::invalid_argument("--case: a name is missing");
    if (std::ranges::count(cases, name) > 1) {
      throw std::invalid_argument("--case: " + name + " is there twice");
    }
  }
  return cases;
}

// The text to print about the runs in `out`; empty if there is none.
std::string text_about(const Call& call, const Matrix& matrix, bool several,
                       const std::vector<RunSummary>& runs, const std::string& out) {
  const std::string results = fmt::format("results: {}\n\n", out);
  if (call.arguments.matrix) return results + matrix_tables(matrix, runs, output_width());
  if (several) {
    return results + comparison_table(call.scenario, runs, call.catalogue, output_width());
  }
  const RunSummary& run = runs.front();
  if (run.failure) return "";
  return fmt::format("{} {}: {:.6g} s simulated in {:.1f} s\n", call.scenario,
                     label_of(call.catalogue, run.folder, call.scenario, run.case_name),
                     run.simulated_s, run.wall_s) +
         results + metrics_table(call.scenario, run, call.catalogue);
}

// Runs the cases, for each value of a matrix, into OUT, OUT/CASE or OUT/VALUE/CASE.
int run_cases(const Call& call) {
  const Arguments& arguments = call.arguments;
  const Matrix matrix = matrix_of(call);
  const std::vector<std::string> cases = cases_of(call);
  const bool several = arguments.matrix || cases.size() > 1 || arguments.cases == kAll;
  check_video(cases.size() * matrix.values.size() > 1, arguments);
  std::vector<PreparedRun> runs;
  std::vector<fs::path> places;
  for (const std::string& value : matrix.values) {
    std::vector<std::string> sets = all_sets(arguments);
    if (arguments.matrix) sets.push_back(matrix.key + "=" + value);
    for (const std::string& name : cases) {
      runs.push_back(prepare_run(call.catalogue, call.scenario, call.file, name, sets));
      places.push_back(fs::path(value) / (several ? name : ""));
    }
  }
  if (arguments.print_config) {
    if (several) throw std::invalid_argument("--print-config: prints one case, not several");
    fmt::print("{}", runs.front().config_text);
    return kSuccess;
  }
  for (PreparedRun& run : runs) run.is_as_shipped = is_as_shipped(call.catalogue, run);

  const std::string name = arguments.matrix ? "matrix" : several ? kAll : cases.front();
  const std::uint64_t seed = runs.front().scenario->run_settings().seed;
  const fs::path out = arguments.out.empty()
                           ? fs::path("runs") / call.scenario / fmt::format("{}-seed{}", name, seed)
                           : fs::path(arguments.out);
  const auto below = [&](const fs::path& place) { return place.empty() ? out : out / place; };
  for (const std::string& value : matrix.values) {
    if (several) check_folder_of_runs(below(value));
  }
  std::vector<fs::path> folders;
  for (const fs::path& place : places) folders.push_back(below(place));
  if (!arguments.quiet) print_warnings(call.scenario, runs);
  const std::vector<RunSummary> summaries =
      execute_runs(runs, folders, {arguments.csv, arguments.quiet, &interrupted(), &call.models});
  report(call.scenario, summaries, arguments.quiet);
  const int video_status = make_videos(summaries, arguments, call.video_program);
  if (!arguments.quiet) {
    fmt::print("{}", text_about(call, matrix, several, summaries, out.string()));
  }
  const bool failed = std::any_of(summaries.begin(), summaries.end(),
                                  [](const RunSummary& run) { return run.failure.has_value(); });
  return failed ? static_cast<int>(kRunFailed) : video_status;
}

}  // namespace

int scenario_main(const Catalogue& catalogue, const std::string& scenario,
                  const std::string& video_program, int argc, const char* const* argv) {
  return guarded(scenario, [&] {
    CLI::App app(scenario + ": " + make_scenario(catalogue, scenario)->summary(), scenario);
    Arguments arguments;
    describe(app, video_program, arguments);
    if (const auto status = parse(app, argc, argv)) return *status;

    const auto read = catalogue.get<ScenarioKind>(scenario).scenario_file(arguments.run.config);
    const ScenarioFile& file = *read;
    if (arguments.list_cases) {
      for (const std::string& name : file.cases()) fmt::print("{}\n", name);
      return static_cast<int>(kSuccess);
    }
    KnownModels models;
    const SharedModels shared([&](const std::string& model) { models.of({model}); });
    stop_on_signals();
    const Call call = {catalogue, scenario, file, video_program, arguments, models};
    try {
      return run_cases(call);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(naming_options(arguments, error.what()));
    }
  });
}

}  // namespace breakwater
