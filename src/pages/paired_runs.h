// breakwater compare --paired: run sets, paired by their seeds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// Runs of one scenario, several of each case: the cases are candidates in the order in which they
/// come first, the seeds that all of them have are the worlds. `metrics` are what is compared;
/// empty: all that any run has. `baseline` is a case, or empty. Throws std::invalid_argument, one
/// line, if there is one case alone, a case has a seed twice, no seed is common to all, or a name
/// is unknown.
PairedResults paired_runs(const std::vector<SavedRun>& runs,
                          const std::vector<std::string>& metrics, const std::string& baseline,
                          const std::map<std::string, Goal>& goals);

}  // namespace breakwater
