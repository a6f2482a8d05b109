#include <breakwater/recorded/recorded_estimation.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include <breakwater/config/config.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/run_tables.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kEstimate = "estimate";
constexpr const char* kObserver = "observer.";

struct Arguments {
  std::string csv;
  std::string observer;
  std::string config;
  std::string tuned;
  std::vector<std::string> sets;
  std::string out;
  bool list_cases = false;
  bool print_config = false;
  bool quiet = false;
};

// The options as sets. `has_settings`: the file has a case for the observer.
std::vector<std::string> sets_of(const Catalogue& catalogue, const Arguments& arguments,
                                 bool has_settings) {
  std::vector<std::string> sets;
  if (!arguments.csv.empty()) sets.push_back("csv.file=" + toml_string(arguments.csv));
  if (!arguments.observer.empty() && !has_settings) {
    sets.push_back("observer.name=" + toml_string(arguments.observer));
  }
  if (!arguments.tuned.empty()) {
    const ScenarioFile tuned(arguments.tuned, scenario_name_in(catalogue, arguments.tuned));
    const Config config = tuned.config(tuned.default_case());
    for (const auto& [key, entry] : config.entries()) {
      if (key.starts_with(kObserver)) sets.push_back(key + "=" + toml_value(entry.value));
    }
  }
  sets.insert(sets.end(), arguments.sets.begin(), arguments.sets.end());
  return sets;
}

int estimate(const Catalogue& catalogue, const Arguments& arguments) {
  stop_on_signals();
  const ScenarioFile file(
      arguments.config.empty() ? recorded_estimation().file().string() : arguments.config,
      kEstimate);
  // The file has a case for each estimator of Breakwater. Another one needs --set.
  const bool has_settings = file.has_case(arguments.observer);
  const std::vector<std::string> sets = sets_of(catalogue, arguments, has_settings);
  const std::string case_name = has_settings ? arguments.observer : file.default_case();
  const Config config = file.config(case_name, sets);
  const ConfigEntry* const name = config.find("observer.name");
  const bool is_other = name != nullptr && name->is_set();
  const std::string called =
      is_other ? config.text("observer.name").value_or(case_name) : case_name;
  if (arguments.list_cases) {
    for (const std::string& one : file.cases()) fmt::print("{}\n", one);
    return kSuccess;
  }
  auto scenario = std::make_unique<RecordedEstimation>(catalogue);
  if (arguments.print_config) {
    // The record may still be missing: the user fills in its name and the other required keys.
    Fields fields = scenario->fields();
    fields.check(file);
    fields.read_incomplete(config);
    fmt::print("{}", fields.print(kEstimate, called));
    return kSuccess;
  }
  const PreparedRun run = prepare_scenario(std::move(scenario), file, case_name, sets, called);
  if (!arguments.quiet) {
    for (const IneffectiveKey& ineffective : run.ineffective) {
      // A tuned file has the keys of all observers.
      if (!arguments.tuned.empty() && ineffective.key.starts_with(kObserver)) continue;
      warn(kEstimate,
           {fmt::format("{}: {}: {}", ineffective.origin, ineffective.key, ineffective.reason)});
    }
    warn(kEstimate, run.scenario->warnings());
  }
  const auto& estimation = static_cast<const RecordedEstimation&>(*run.scenario);
  const std::string& csv = estimation.file();
  const fs::path folder = arguments.out.empty() ? fs::path("runs") / kEstimate / run.case_name
                                                : fs::path(arguments.out);
  const RunSummary summary =
      execute_runs({run}, {folder}, {.csv = true, .quiet = arguments.quiet, .stop = &interrupted()})
          .front();
  if (arguments.quiet) return kSuccess;
  // A forgotten scale is one cause. Its consequence would hide it.
  const auto doubt = estimation.is_doubtful() ? std::nullopt : doubt_of(summary.metrics);
  if (doubt) warn(kEstimate, {csv + ": " + *doubt});
  fmt::print("{} {}: {:.6g} s of {}\nresults: {}\n\n{}", kEstimate, run.case_name,
             summary.simulated_s, csv, summary.folder.string(),
             metrics_table(kEstimate, summary, catalogue));
  return kSuccess;
}

int estimate_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " " + kEstimate;
  return guarded(program, [&] {
    CLI::App app("Runs a disturbance estimator on recorded data, without a simulation.", program);
    Arguments arguments;
    app.add_option("--csv", arguments.csv,
                   "read this table with the columns time_s, u and y\n"
                   "(the keys csv.time_column, ... set other names)")
        ->type_name("FILE");
    app.add_option("--observer", arguments.observer,
                   "use this estimator of an axis (see " + own_program_name() +
                       " list --parts)\nor this case of the file (--list-cases; default: stf)")
        ->type_name("NAME");
    app.add_option("--config", arguments.config,
                   "read settings from this file, such as an earlier result's config.toml")
        ->type_name("FILE");
    app.add_option("--tuned", arguments.tuned,
                   "take the observer and its keys observer.* from this scenario file, such as "
                   "tune's\ntuned/CASE.toml")
        ->type_name("FILE")
        ->excludes("--observer");
    app.add_option("--set", arguments.sets,
                   "set a key of the plant, encoder, units, ... (--print-config shows all keys)")
        ->type_name("KEY=VALUE");
    app.add_option("--out", arguments.out,
                   "write the result to this folder (default: runs/estimate/NAME)")
        ->type_name("DIR");
    app.add_flag("--quiet", arguments.quiet, "print errors only");
    app.add_flag("--list-cases", arguments.list_cases,
                 "print the file's cases, one a line, and exit");
    app.add_flag("--print-config", arguments.print_config,
                 "print the effective configuration and exit");
    app.footer(
        "The folder gets log.csv and log.h5 with the estimates of each row, metrics.json,\n"
        "config.toml and manifest.json. The estimator predicts over gaps, and a warning lists "
        "them.\n"
        "Exit status: 0 success, 1 a defect, 2 usage or input, 130 "
        "interrupted.");
    if (const auto status = parse(app, argc, argv)) return *status;
    return estimate(catalogue, arguments);
  });
}

}  // namespace

CommandKind estimate_command() {
  return {kEstimate, "run an estimator on recorded data: estimate --csv FILE --observer NAME",
          estimate_main};
}

}  // namespace breakwater
