// A short summary of the folder of a study or tuning.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/record/recording.h>

namespace breakwater {

/// Whether the folder is from a sweep or a tuning.
bool is_study_folder(const std::filesystem::path& folder);

struct StudySummary {
  std::filesystem::path folder;
  const char* kind = "study";  ///< or "tuning"
  std::string scenario;
  std::size_t runs = 0;  ///< finished so far
  std::size_t failed = 0;
  std::vector<Metric> medians;  ///< per metric, over the runs that have it; without units
  std::filesystem::file_time_type written;
};

/// Reads all results. Throws std::invalid_argument if they cannot be read.
StudySummary summarise_study(const std::filesystem::path& folder);

}  // namespace breakwater
