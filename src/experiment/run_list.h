// The runs below a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/record/recording.h>

namespace breakwater {

/// What lies below a folder.
struct FoundRuns {
  std::vector<std::filesystem::path> runs;        ///< folders with a manifest.json
  std::vector<std::filesystem::path> unfinished;  ///< hidden, of runs that were never done
  std::vector<std::filesystem::path> others;      ///< what `is_other` took: a study, say
};

/// The folder itself is looked at too. What is found is not looked into; symbolic links are not
/// followed, and folders that cannot be read hold nothing. Throws std::invalid_argument if there is
/// no such folder.
FoundRuns find_runs(const std::filesystem::path& below,
                    const std::function<bool(const std::filesystem::path&)>& is_other);

/// A run as far as its small files tell; its log is not opened.
struct ListedRun {
  enum class Status { complete, failed, damaged };
  std::filesystem::path folder;
  Status status = Status::damaged;
  std::string reason;  ///< why it is not complete
  std::string scenario;
  std::string case_name;
  std::string seed;
  std::vector<Metric> metrics;
  std::filesystem::file_time_type written;
};
ListedRun list_run(const std::filesystem::path& folder);

/// "complete", "failed" or "damaged".
const char* name_of(ListedRun::Status status);

}  // namespace breakwater
