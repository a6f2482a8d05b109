// Runs a case of a scenario inside the test.
#pragma once

#include <string>
#include <vector>

#include "catalogue.h"
#include "record/recording.h"

namespace breakwater::testing {

inline Recording run_case(const std::string& scenario, const std::string& case_name,
                          const std::vector<std::string>& sets = {},
                          const RunControl& control = {}) {
  return prepare(scenario, case_name, sets).scenario->run(control);
}

}  // namespace breakwater::testing
