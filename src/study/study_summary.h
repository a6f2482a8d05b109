// A study's or a tuning's folder in a few numbers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/record/recording.h>

namespace breakwater {

/// Whether a sweep or a tuning left the folder.
bool is_study_folder(const std::filesystem::path& folder);

struct StudySummary {
  std::filesystem::path folder;
  const char* kind = "study";  ///< or "tuning"
  std::string scenario;
  std::size_t runs = 0;  ///< that are there by now
  std::size_t failed = 0;
  std::vector<Metric> medians;  ///< of each metric, over the runs that have it; no units
  std::filesystem::file_time_type written;
};

/// Reads all of its results. Throws std::invalid_argument if they cannot be read.
StudySummary summarise_study(const std::filesystem::path& folder);

}  // namespace breakwater
