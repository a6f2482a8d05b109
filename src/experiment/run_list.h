// The runs below a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <breakwater/record/recording.h>

namespace breakwater {

/// The contents of a folder.
struct FoundRuns {
  std::vector<std::filesystem::path> runs;        ///< folders with a manifest.json
  std::vector<std::filesystem::path> unfinished;  ///< hidden folders of unfinished runs
  std::vector<std::filesystem::path> others;  ///< folders that `is_other` accepts, such as studies
};

/// Searches `below`, including the folder itself. It does not search inside the found folders, and
/// does not follow symbolic links. A folder that cannot be read counts as empty. Throws
/// std::invalid_argument if `below` does not exist.
FoundRuns find_runs(const std::filesystem::path& below,
                    const std::function<bool(const std::filesystem::path&)>& is_other);

/// The summary of a run from its small files. The log is not opened.
struct ListedRun {
  std::filesystem::path folder;
  std::string status = "damaged";  ///< or "complete", "failed", "cut", kRunning
  std::string reason;              ///< if it is not complete
  std::string scenario;
  std::string case_name;
  std::string seed;
  std::vector<Metric> metrics;
  std::filesystem::file_time_type written;
};
ListedRun list_run(const std::filesystem::path& folder);

}  // namespace breakwater
