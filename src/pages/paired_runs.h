// breakwater compare --paired: runs that are paired by their seeds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
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

/// One line if the runs differ in more than their cases and seeds do; else nothing. It names the
/// keys and their values: paired by the seed alone, such runs may have other test conditions.
std::vector<std::string> other_differences(const Catalogue& catalogue,
                                           const std::vector<SavedRun>& runs);

}  // namespace breakwater
