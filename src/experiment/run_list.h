// The list of the runs below a folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/record/recording.h>

namespace breakwater {

/// A run or study in the list.
struct ListedFolder {
  std::filesystem::path folder;
  std::filesystem::file_time_type written = {};
  std::string kind = "run";        ///< or "study", "tuning"
  std::string status = "damaged";  ///< or "complete", "failed", "cut", kRunning; a study's results
  std::string scenario = "";       ///< empty: unknown
  std::string reason = "";         ///< if it is not complete
  std::string case_name = "";      ///< only a run has it
  std::string seed = "";
  std::vector<Metric> metrics = {};
  std::size_t runs = 0;  ///< that a study has finished so far
  std::size_t failed = 0;
};

/// The summary of a run from its small files. The log is not opened.
ListedFolder list_run(const std::filesystem::path& folder);

}  // namespace breakwater
