// The command line of `sweep`: what is run, as the tables of a study file.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include <breakwater/config/toml_file.h>
#include <breakwater/program/run_changes.h>
#include <breakwater/program/study_command.h>

namespace breakwater {

struct SweepOptions {
  StudyOptions study;
  RunChanges run;
  std::map<std::string, std::vector<std::string>> what;  ///< others that say what is run: "--vary"
  bool sqlite = false;

  /// Whether any option says what is run.
  bool says_what() const;
};

void add_sweep_options(CLI::App& app, SweepOptions& options);

/// Lays what the options say on the tables of a study file. Throws std::invalid_argument `OPTION:
/// reason`.
void lay_on(const SweepOptions& options, toml::table& tables);

}  // namespace breakwater
