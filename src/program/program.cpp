#include <breakwater/program/program.h>

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include <breakwater/analysis/analyze_command.h>
#include <breakwater/pictures/picture_commands.h>
#include <breakwater/program/doctor.h>
#include <breakwater/program/new_project.h>
#include <breakwater/program/run_commands.h>
#include <breakwater/program/waves_report.h>
#include <breakwater/report/report_commands.h>
#include <breakwater/report/study_report.h>
#include <breakwater/report/tuning_report.h>
#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario/command_kind.h>
#include <breakwater/scenario/process.h>
#include <breakwater/scenario_program/own_places.h>
#include <breakwater/scenario_program/run_extras.h>
#include <breakwater/study/sweep_command.h>
#include <breakwater/tuning/tune_command.h>
#include <breakwater/version.h>

namespace breakwater {
namespace {

// CLI11 would only say that a command is required.
void refuse_unknown_command(const Catalogue& catalogue, const CLI::App& app,
                            const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), word) != names.end()) return;
  throw std::invalid_argument(own_program_name() + ": there is no command \"" + word + "\"" +
                              (catalogue.has<ScenarioKind>(word)
                                   ? " (did you mean run " + word + "?)"
                                   : did_you_mean(word, names)));
}

void print_list(const Catalogue& catalogue, bool parts) {
  if (!parts) {
    for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
      fmt::print("{:<20}{}\n", kind.name, kind.make(catalogue)->summary());
    }
    return;
  }
  std::vector<std::string> headings;
  for (const ListedPart& part : catalogue.parts()) {
    if (std::find(headings.begin(), headings.end(), part.what) == headings.end()) {
      headings.push_back(part.what);
    }
  }
  for (const std::string& heading : headings) {
    fmt::print("{}{}\n", heading == headings.front() ? "" : "\n", heading);
    for (const ListedPart& part : catalogue.parts()) {
      if (part.what == heading) fmt::print("  {:<18}{}\n", part.name, part.help);
    }
  }
}

}  // namespace

namespace detail {

int program(int argc, const char* const* argv, const Catalogue& catalogue,
            const char* installation) {
  const std::string own_name = own_program_name();
  set_places(catalogue, installation);
  if (argc >= 2 && is_picture_command(argv[1])) return picture_main(catalogue, argc - 1, argv + 1);
  if (argc >= 2 && is_report_command(argv[1])) return report_main(catalogue, argc - 1, argv + 1);
  if (argc >= 2 && std::string(argv[1]) == kSweep) {
    StudyExtras extras;
    extras.write_report = [&](const Plan& plan, const ShardIndex& index, const StudyFolder& folder,
                              const std::optional<CandidateComparison>& comparison) {
      write_study_report(catalogue, plan, index, folder, comparison);
    };
    return sweep_main(catalogue, extras, argc - 1, argv + 1);
  }
  if (argc >= 2 && std::string(argv[1]) == kTune) {
    return tune_main(catalogue, {write_tuning_report}, argc - 1, argv + 1);
  }
  if (argc >= 2 && std::string(argv[1]) == kAnalyze)
    return analyze_main(catalogue, argc - 1, argv + 1);
  if (argc >= 2 && std::string(argv[1]) == kNewProject) {
    return new_project_main(catalogue, argc - 1, argv + 1);
  }
  if (argc >= 2 && std::string(argv[1]) == kListRuns) {
    return list_runs_main(catalogue, argc - 1, argv + 1);
  }
  if (argc >= 2 && std::string(argv[1]) == kRemoveRuns) {
    return remove_runs_main(argc - 1, argv + 1);
  }
  if (argc >= 2 && std::string(argv[1]) == kDoctor) {
    return doctor_main(catalogue, argc - 1, argv + 1);
  }
  if (argc >= 2 && catalogue.has<CommandKind>(argv[1])) {
    return catalogue.get<CommandKind>(argv[1]).run(catalogue, argc - 1, argv + 1);
  }
  if (argc >= 3 && std::string(argv[1]) == "run" && argv[2][0] != '-') {
    return guarded(own_name, [&] {
      const std::string scenario = catalogue.get<ScenarioKind>(argv[2]).name;
      return scenario_main(catalogue, scenario, run_extras(own_program()), argc - 2, argv + 2);
    });
  }
  return guarded(own_name, [&] {
    CLI::App app("Breakwater: a testbed for robust model-based motion control.", own_name);
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string(kVersion) + " (" + kGitCommit + ")");
    CLI::App* list = app.add_subcommand("list", "print the scenarios and what they study");
    bool parts = false;
    list->add_flag("--parts", parts, "the controllers and estimators instead");
    std::string scenario;
    CLI::App* run = app.add_subcommand(
        "run", "run a scenario: run NAME [OPTION...]; run NAME --help says which");
    run->add_option("NAME", scenario, "which scenario (see list)")->required();
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
    app.add_subcommand(kSweep, "very many runs as one table: sweep SCENARIO|STUDY.toml|DIR");
    app.add_subcommand(kTune, "the best values of some keys, as a front: tune TUNE.toml|DIR");
    app.add_subcommand(kAnalyze, "loops of one axis in the frequency domain: analyze SCENARIO");
    app.add_subcommand(kNewProject,
                       "make a project of your own: new controller|observer|scenario NAME");
    app.add_subcommand(kListRuns, "the runs and studies below a folder, newest first: ls [DIR]");
    app.add_subcommand(kRemoveRuns, "remove runs that failed: rm --failed [DIR]");
    app.add_subcommand(kDoctor, "what works on this machine, and what to install for the rest");
    for (const CommandKind& own : catalogue.all<CommandKind>()) {
      app.add_subcommand(own.name, own.summary);
    }
    for (const auto& [name, summary] : picture_commands()) app.add_subcommand(name, summary);
    for (const auto& [name, summary] : report_commands()) app.add_subcommand(name, summary);
    if (argc >= 2 && argv[1][0] != '-') refuse_unknown_command(catalogue, app, argv[1]);
    if (const auto status = parse(app, argc, argv)) return *status;
    if (waves->parsed()) fmt::print("{}", waves_report(sea));
    if (list->parsed()) print_list(catalogue, parts);
    return static_cast<int>(kSuccess);
  });
}

}  // namespace detail
}  // namespace breakwater
