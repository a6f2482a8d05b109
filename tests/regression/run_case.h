// Runs a case of a scenario inside the test.
#pragma once

#include <string>
#include <vector>

#include <breakwater/record/recording.h>
#include "catalogue.h"

namespace breakwater::testing {

inline Recording run_case(const std::string& scenario, const std::string& case_name,
                          const std::vector<std::string>& sets = {},
                          const RunControl& control = {}) {
  return prepare(scenario, case_name, sets).scenario->run(control);
}

}  // namespace breakwater::testing
