// Runs a case of a scenario inside the test.
#pragma once

#include <string>
#include <vector>

#include "record/recording.h"
#include "scenario/runner.h"

namespace breakwater::testing {

inline Recording run_case(const std::string& scenario, const std::string& case_name,
                          const std::vector<std::string>& sets = {},
                          const RunControl& control = {}) {
  const ScenarioFile file(scenario_file(scenario).string(), scenario);
  return prepare_run(scenario, file, case_name, sets).scenario->run(control);
}

}  // namespace breakwater::testing
