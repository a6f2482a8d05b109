// The models of a study's runs, which must not change while it runs.
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <breakwater/scenario/provenance.h>

namespace breakwater {

/// Hashes of models, each file read once, and how the file system described it then. Thread-safe.
class KnownModels {
 public:
  /// model_hashes() of these files as they were at the first call for them.
  const ModelHashes& of(const std::vector<std::string>& files);

  /// Throws std::invalid_argument `FILE: was changed while it ran: start again` if one of the files
  /// that of() was called for has other bytes now. While none was touched, it reads none.
  void check_unchanged(const std::vector<std::string>& files) const;
  /// The same of all files.
  void check_unchanged() const;

 private:
  struct File {
    std::filesystem::path path;
    struct stat status = {};  // of just before it was read
    std::string hash;
  };
  struct Known {
    ModelHashes hashes;
    std::vector<File> files;
  };

  static void check(const Known& known);

  std::map<std::vector<std::string>, Known> known_;  // what is in it stays as it is
  mutable std::mutex mutex_;
};

}  // namespace breakwater
