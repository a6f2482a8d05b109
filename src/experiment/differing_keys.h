// In what finished runs differ: from their case as it is shipped, and among each other.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/saved_run.h>

namespace breakwater {

/// A key whose value in a run is not the shipped case's; values as TOML has them.
struct ChangedKey {
  std::string key;
  std::string value;
  std::string shipped;
};

/// The keys of a run that differ from its case in the scenario's own file. Empty where this program
/// does not have the scenario, or the file not the case.
std::vector<ChangedKey> changed_keys(const Catalogue& catalogue, const SavedRun& run);

/// A key that is not the same in all runs, and its value in each; "–" where a run does not have it.
struct DifferingKey {
  std::string key;
  std::vector<std::string> values;
};
std::vector<DifferingKey> differing_keys(const std::vector<SavedRun>& runs);

/// How to tell runs apart: by case, with the parts that a run has instead of its case's:
/// "hpfc-5N with mine"; where several are of one case, by the keys in which these
/// differ, if they are few: "hpfc-5N, wall.distance_m=0.1"; else by folder.
std::vector<std::string> labels_of(const Catalogue& catalogue, const std::vector<SavedRun>& runs);

}  // namespace breakwater
