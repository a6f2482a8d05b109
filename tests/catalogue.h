// Breakwater's own scenarios, inside a test.
#pragma once

#include <breakwater/experiment/runner.h>
#include <breakwater/program/program.h>
#include "support.h"

namespace breakwater::testing {

inline const Catalogue& catalogue() {
  static const Catalogue all = standard_catalogue();
  return all;
}

inline std::vector<std::string> scenario_names() {
  return catalogue().names<ScenarioKind>();
}

/// The scenario file that belongs to a scenario.
inline ScenarioFile scenario_file(const std::string& scenario) {
  return {catalogue().get<ScenarioKind>(scenario).file().string(), scenario};
}

inline PreparedRun prepare(const std::string& scenario, const std::string& case_name,
                           const std::vector<std::string>& sets = {}) {
  return prepare_run(catalogue(), scenario, scenario_file(scenario), case_name, sets);
}

}  // namespace breakwater::testing
