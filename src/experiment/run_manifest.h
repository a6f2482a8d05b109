// manifest.json of a run's folder, read back.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <breakwater/experiment/provenance.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// What is empty was not known to the version that wrote it.
struct RunManifest {
  std::string scenario;
  std::string case_name;
  std::string seed;
  std::string state_hash;
  std::optional<Failure> failure;  ///< if the run failed
  std::string program;             ///< program_hash()
  ModelHashes models;
};

/// Throws std::invalid_argument `FILE: KEY: reason` if the folder has no manifest of a run, or a
/// damaged one.
RunManifest read_manifest(const std::filesystem::path& folder);

/// Notes in the manifest of the run in `folder`, if that is still the one with this state hash,
/// what drew `picture` ("video.mp4"): `renderers.PICTURE`. Throws OutputError.
void note_renderer(const std::filesystem::path& folder, const std::string& state_hash,
                   const std::string& picture, const std::string& renderer);

}  // namespace breakwater
