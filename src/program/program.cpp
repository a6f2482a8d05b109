#include <breakwater/program/program.h>

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include <breakwater/analysis/analysis_outputs.h>
#include <breakwater/config/config.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/version.h>
#include <breakwater/identification/identification_outputs.h>
#include <breakwater/pages/run_report.h>
#include <breakwater/pictures/picture_commands.h>
#include <breakwater/program/command_line.h>
#include <breakwater/program/commands.h>
#include <breakwater/program/scenario_program.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/did_you_mean.h>
#include <breakwater/shell/process.h>
#include <breakwater/study/study_folder.h>
#include <breakwater/thesis/thesis_report.h>

namespace breakwater {
namespace {

void print_scenarios(const Catalogue& catalogue) {
  std::size_t width = 0;
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    width = std::max(width, kind.name.size());
  }
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    fmt::print("{:<{}} {}\n", kind.name, width, kind.make(catalogue)->summary());
  }
}

void print_parts(const Catalogue& catalogue) {
  std::vector<std::string> headings;
  for (const ListedPart& part : catalogue.parts()) {
    if (std::find(headings.begin(), headings.end(), part.what) == headings.end()) {
      headings.push_back(part.what);
    }
  }
  std::size_t width = 0;
  for (const ListedPart& part : catalogue.parts()) width = std::max(width, part.name.size());
  for (const std::string& heading : headings) {
    fmt::print("{}{}\n", heading == headings.front() ? "" : "\n", heading);
    for (const ListedPart& part : catalogue.parts()) {
      if (part.what == heading) fmt::print("  {:<{}} {}\n", part.name, width, part.help);
    }
  }
}

int list_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " list";
  return guarded(program, [&] {
    CLI::App app("print the scenarios and what they study", program);
    bool parts = false;
    app.add_flag("--parts", parts, "the controllers and estimators instead");
    if (const auto status = parse(app, argc, argv)) return *status;
    parts ? print_parts(catalogue) : print_scenarios(catalogue);
    return static_cast<int>(kSuccess);
  });
}

int run_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  return guarded(own_program_name(), [&] {
    if (argc >= 2 && is_scenario_file(argv[1])) {
      // The same as run NAME --config FILE.
      const std::string scenario = scenario_name_in(catalogue, argv[1]);
      std::vector<const char*> words = {argv[0], "--config"};
      words.insert(words.end(), argv + 1, argv + argc);
      return scenario_main(catalogue, scenario, own_program(), static_cast<int>(words.size()),
                           words.data());
    }
    if (argc >= 2 && argv[1][0] != '-') {
      const std::string scenario = catalogue.get<ScenarioKind>(argv[1]).name;
      return scenario_main(catalogue, scenario, own_program(), argc - 1, argv + 1);
    }
    CLI::App app("run a scenario: run NAME [OPTION...]; run NAME --help says which",
                 own_program_name() + " run");
    std::string scenario;
    app.add_option("NAME", scenario, "which scenario (see list), or a scenario file")->required();
    return parse(app, argc, argv).value_or(kSuccess);
  });
}

}  // namespace

// In the order and the groups of the help. Commands of the catalogue are among them.
std::vector<CommandKind> all_commands(const Catalogue& catalogue) {
  std::vector<CommandKind> all;
  const auto add = [&](const char* group, const std::vector<CommandKind>& commands) {
    for (CommandKind command : commands) {
      command.group = group;
      all.push_back(command);
    }
  };
  constexpr const char* kRuns = "Run and look";
  add(kRuns,
      {{"list", "print the scenarios and what they study", list_main},
       {"run", "run a scenario: run NAME [OPTION...]; run NAME --help says which", run_main},
       {"ls", "list the runs and studies in a folder, newest first: ls [DIR]", list_runs_main}});
  add(kRuns, picture_commands());
  add(kRuns, report_commands());
  add(kRuns, {{"diff", "find the first sample in which two runs differ: diff RUN RUN", diff_main}});
  add("Study",
      {{kSweep.command, "run a scenario over many values and seeds: sweep SCENARIO|STUDY.toml|DIR",
        sweep_main},
       {kTune.command, "search for the best values of some keys: tune TUNE.toml|DIR", tune_main},
       {kAnalyze, "measure a control loop over frequency: analyze SCENARIO|FILE.toml",
        analyze_main}});
  add("Thesis", {reproduce_command()});
  add(CommandKind().group,
      {{"new", "make a project of your own: new controller|observer|plant|robot|scenario NAME",
        new_project_main}});
  add(CommandKind().group, catalogue.all<CommandKind>());
  add(CommandKind().group, {identify_command()});
  add("Tools",
      {{"convert", "convert a model file of MuJoCo 3: convert FILE.xml --out DIR", convert_main},
       {"doctor", "check what works on this machine, and what to install", doctor_main},
       {"reference", "write the reference pages: commands, keys, metrics, columns",
        reference_main}});
  return all;
}

namespace detail {

int program(int argc, const char* const* argv, const Catalogue& catalogue,
            const char* installation) {
  set_places(catalogue, installation);
  const std::vector<CommandKind> commands = all_commands(catalogue);
  const std::string word = argc >= 2 ? argv[1] : "";
  for (const CommandKind& command : commands) {
    if (command.name == word) return command.run(catalogue, argc - 1, argv + 1);
  }
  const std::string own_name = own_program_name();
  return guarded(own_name, [&] {
    CLI::App app("Breakwater: a testbed for robust model-based motion control.", own_name);
    app.set_version_flag("--version", std::string(kVersion) + " (" + kGitCommit + ")");
    std::vector<std::string> names;
    for (const CommandKind& command : commands) {
      app.add_subcommand(command.name, command.summary)->group(command.group);
      names.push_back(command.name);
    }
    if (argc < 2) {
      fmt::print("{}", app.help());
      return static_cast<int>(kSuccess);
    }
    if (!word.starts_with('-') || word == "--") {  // the parser would take "--" in silence
      throw std::invalid_argument(own_name + ": there is no command \"" + word + "\"" +
                                  (catalogue.has<ScenarioKind>(word)
                                       ? " (did you mean run " + word + "?)"
                                       : did_you_mean(word, names)));
    }
    return parse(app, argc, argv).value_or(kSuccess);
  });
}

}  // namespace detail
}  // namespace breakwater
