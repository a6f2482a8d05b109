// breakwater compare --paired: runs that are paired by their seeds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/statistics/paired_comparison.h>

namespace breakwater {

/// Pairs runs of one scenario. The cases are the candidates, in the order of their first run. The
/// seeds that all cases have are the test conditions. `metrics` selects the metrics; empty means
/// all. `baseline` is a case or empty. Throws std::invalid_argument if there is only one case, a
/// case has a seed twice, the cases have no common seed, or a name is unknown.
PairedResults paired_runs(const std::vector<SavedRun>& runs,
                          const std::vector<std::string>& metrics, const std::string& baseline,
                          const std::map<std::string, Goal>& goals);

}  // namespace breakwater
