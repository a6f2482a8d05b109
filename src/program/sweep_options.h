// The command line of `sweep`, converted to the tables of a study file.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/config/toml_file.h>
#include <breakwater/program/command_line.h>
#include <breakwater/program/study_command.h>

namespace CLI {
class App;
}

namespace breakwater {

struct SweepOptions {
  StudyOptions study;
  RunChanges run;
  std::map<std::string, std::vector<std::string>>
      what;  ///< options of the study itself, such as "--vary"
  bool sqlite = false;
  bool all = false;  ///< print every table

  /// Whether an option defines the study.
  bool says_what() const;
};

void add_sweep_options(CLI::App& app, SweepOptions& options);

/// Merges KEY=VALUE into [set] of a study's file. Throws std::invalid_argument (`--set: reason`).
void lay_sets(const std::vector<std::string>& sets, const std::string& file, toml::table& tables);

/// Merges the options into the tables of a study file. Throws std::invalid_argument (`OPTION:
/// reason`).
void lay_on(const SweepOptions& options, toml::table& tables);

}  // namespace breakwater
