// The models of many runs, which must not change while they run.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/provenance.h>

namespace breakwater {

/// Hashes of models. Thread-safe.
///
/// A hash belongs to the compiled model if the file is noted before the compilation (SharedModels)
/// and is unchanged after the run.
class KnownModels {
 public:
  /// The hashes of these files and of those that they include, as they were when they were first
  /// noted: at the first call. Throws std::invalid_argument `FILE: cannot be read`.
  ModelHashes of(const std::vector<std::string>& files);

  /// Throws std::invalid_argument `FILE: was changed while it ran: start again` if a file of these
  /// models has changed. A run checks its own alone: a study may have many large ones.
  void check_unchanged(const std::vector<std::string>& models) const;
  /// The same for all models.
  void check_unchanged() const;

 private:
  using File = std::pair<const std::filesystem::path, std::string>;  // with its hash
  using Files = std::vector<const File*>;

  const Files& noted(const std::string& file);
  static void check(const Files& files);

  // The entries do not change.
  std::map<std::filesystem::path, std::string> files_;
  std::map<std::string, Files> models_;  // an MJCF file, and all files that it includes
  mutable std::mutex mutex_;
};

/// The hashes of these files and of those that they include.
inline ModelHashes model_hashes(const std::vector<std::string>& files) {
  return KnownModels().of(files);
}

}  // namespace breakwater
