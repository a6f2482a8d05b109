// Differences of finished runs, from their shipped case and among each other.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/saved_run.h>

namespace breakwater {

/// A key that differs between runs, and its value in each; "–" if a run does not have it.
struct DifferingKey {
  std::string key;
  std::vector<std::string> values;
};
std::vector<DifferingKey> differing_keys(const std::vector<SavedRun>& runs);

/// The keys that a run and its case in the scenario's own file have with different values. Empty if
/// the program does not have the scenario, or the file not the case. Also empty for another plant,
/// that is, if the run has a table that the file lacks, such as [axis.mine].
std::vector<DifferingKey> changed_keys(const Catalogue& catalogue,
                                       const std::filesystem::path& folder,
                                       const std::string& scenario, const std::string& case_name);

/// A label for a finished run of any size: its case, with changed parts: "hpfc-5N with mine".
std::string label_of(const Catalogue& catalogue, const std::filesystem::path& folder,
                     const std::string& scenario, const std::string& case_name);

/// A label for each run: its case, with changed parts: "hpfc-5N with mine". Runs of one case get
/// their differing keys, if these are few: "hpfc-5N, wall.distance_m=0.1". Otherwise the label is
/// the folder.
std::vector<std::string> labels_of(const Catalogue& catalogue, const std::vector<SavedRun>& runs);

}  // namespace breakwater
