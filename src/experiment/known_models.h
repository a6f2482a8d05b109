// The models of many runs, which must not change while they run.
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <breakwater/experiment/provenance.h>

namespace breakwater {

/// Hashes of models, each file read once, and how the file system described it then. Thread-safe.
///
/// A hash is that of what was compiled if its file is noted before it is compiled (SharedModels)
/// and unchanged once the run has ended.
class KnownModels {
 public:
  /// Reads an MJCF file and all that it has read in, unless they are known.
  void note(const std::string& file);
  /// model_hashes() of these files as they were when each was noted, at the latest now.
  const ModelHashes& of(const std::vector<std::string>& files);

  /// Throws std::invalid_argument `FILE: was changed while it ran: start again` if one of the files
  /// that of() was called for has other bytes now. While none was touched, it reads none.
  void check_unchanged(const std::vector<std::string>& files) const;
  /// The same of all files.
  void check_unchanged() const;

 private:
  struct File {
    std::filesystem::path path = {};
    struct stat status = {};  // of just before it was read
    std::string hash = {};
  };
  using Files = std::vector<const File*>;

  const Files& noted(const std::string& file);
  static void check(const File& file);

  // What is in them stays as it is.
  std::map<std::filesystem::path, File> files_;
  std::map<std::string, Files> models_;  // an MJCF file, and all that it has read in
  std::map<std::vector<std::string>, ModelHashes> hashes_;
  mutable std::mutex mutex_;
};

}  // namespace breakwater
