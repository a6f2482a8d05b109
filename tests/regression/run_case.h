// Runs a case of a scenario inside the test.
#pragma once

#include <breakwater/record/recording.h>
#include "catalogue.h"

namespace breakwater::testing {

using Sets = std::vector<std::string>;

inline Sets operator+(Sets a, const Sets& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline Recording run_case(const std::string& scenario, const std::string& case_name,
                          const Sets& sets = {}, const RunControl& control = {}) {
  return prepare(scenario, case_name, sets).scenario->run(control);
}

/// A run without a log, as in a sweep: the same states and metrics (UnwatchedRuns) sooner.
inline const RunControl kWithoutLog{.logs = false};

/// Runs a case that must not fail. Throws std::runtime_error if it does.
inline Recording completed_run(const std::string& scenario, const std::string& case_name,
                               const Sets& sets = {}, const RunControl& control = {}) {
  Recording run = run_case(scenario, case_name, sets, control);
  if (!run.failure) return run;
  throw std::runtime_error(scenario + " " + case_name + ": " + run.failure->reason);
}

/// arm_wall_contact with the switch to force control at 7 s instead of 30 s.
inline Sets switched_at_7_s(int duration_s) {
  const std::string duration = std::to_string(duration_s);
  return {"run.duration_s=" + duration, "wall.solid_from_s=6", "force.from_s=7",
          "record.fine_from_s=6.9", "record.fine_to_s=" + duration};
}

}  // namespace breakwater::testing
