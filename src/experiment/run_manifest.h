// Reads manifest.json and metrics.json of a run's folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/provenance.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// The status of a streamed run in its manifest until it ends.
inline constexpr const char* kRunning = "running";

/// A member is empty if the version that wrote the manifest did not know it.
struct RunManifest {
  std::string scenario;
  std::string case_name;
  std::string seed;
  std::string state_hash;
  std::optional<Failure> failure;  ///< if the run failed or was cut
  bool is_unfinished = false;      ///< it was cut; the time of its failure is that of its log
  std::string program;             ///< program_hash()
  ModelHashes models;
  std::vector<AbsentMetric> absent;  ///< without units
  std::vector<std::string> warnings;
  std::vector<Metric> metrics;  ///< from metrics.json: see read_metrics()
};

/// Throws std::invalid_argument `FILE: KEY: reason` if the manifest is missing or damaged.
RunManifest read_manifest(const std::filesystem::path& folder);

/// The metrics of a complete run, in the scenario's order. Throws std::invalid_argument, one line,
/// if they are missing or damaged.
std::vector<Metric> read_metrics(const std::filesystem::path& folder);

}  // namespace breakwater
