// The command line of a scenario, in its own binary and in `run NAME`.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace CLI {
class App;
}

namespace breakwater {

struct RunChanges {
  std::string config;
  std::vector<std::string> sets;
  std::string duration;
};

/// Adds --config, --set and --duration to a group of the help.
void add_run_changes(CLI::App& app, RunChanges& options, const std::string& config_help,
                     const std::string& set_help, const std::string& group = "Options");

/// Adds OPTION=VALUE as a set of `key`, if the option was given. Throws std::invalid_argument if a
/// --set has the same key.
void add_set(std::vector<std::string>& sets, const std::string& option, const std::string& key,
             const std::string& value);
/// All sets, including that of --duration.
std::vector<std::string> all_sets(const RunChanges& options);

/// main() of a scenario. The program `video_program` makes the videos of --video. Exit status: 0
/// success, 1 an internal error, 2 usage or input, 3 a run failed, 4 only a video failed, 130
/// interrupted.
int scenario_main(const Catalogue& catalogue, const std::string& scenario,
                  const std::string& video_program, int argc, const char* const* argv);

}  // namespace breakwater
