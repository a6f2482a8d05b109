// Runs a case of a scenario inside the test.
#pragma once

#include <breakwater/record/recording.h>
#include "catalogue.h"

namespace breakwater::testing {

inline Recording run_case(const std::string& scenario, const std::string& case_name,
                          const std::vector<std::string>& sets = {},
                          const RunControl& control = {}) {
  return prepare(scenario, case_name, sets).scenario->run(control);
}

/// Runs a case that must not fail. Throws std::runtime_error if it does.
inline Recording completed_run(const std::string& scenario, const std::string& case_name,
                               const std::vector<std::string>& sets = {}) {
  Recording run = run_case(scenario, case_name, sets);
  if (!run.failure) return run;
  throw std::runtime_error(scenario + " " + case_name + ": " + run.failure->reason);
}

}  // namespace breakwater::testing
