#include <breakwater/experiment/known_models.h>

#include <stdexcept>

#include <breakwater/plants/mjcf_tree.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/shell/paths.h>

namespace breakwater {

const KnownModels::Files& KnownModels::noted(const std::string& file) {
  const auto found = models_.find(file);
  if (found != models_.end()) return found->second;
  const std::vector<std::filesystem::path> paths = mjcf_files(file);
  if (paths.empty()) throw std::invalid_argument(file + ": cannot be read");
  Files files;
  for (const auto& path : paths) {
    auto known = files_.find(path);
    if (known == files_.end()) known = files_.emplace(path, file_hash(path)).first;
    files.push_back(&*known);
  }
  return models_.emplace(file, std::move(files)).first->second;
}

ModelHashes KnownModels::of(const std::vector<std::string>& files) {
  const std::lock_guard lock(mutex_);
  ModelHashes hashes;
  for (const std::string& model : files) {
    for (const File* file : noted(model)) hashes[portable_path(file->first)] = file->second;
  }
  return hashes;
}

void KnownModels::check(const Files& files) {
  for (const File* file : files) {
    const auto& [path, hash] = *file;
    if (file_hash(path) == hash) continue;
    throw std::invalid_argument(path.string() + ": was changed while it ran: start again");
  }
}

void KnownModels::check_unchanged(const std::vector<std::string>& models) const {
  Files files;
  {
    const std::lock_guard lock(mutex_);
    for (const std::string& model : models) {
      const auto known = models_.find(model);
      if (known == models_.end()) continue;
      files.insert(files.end(), known->second.begin(), known->second.end());
    }
  }
  check(files);
}

void KnownModels::check_unchanged() const {
  Files files;
  {
    const std::lock_guard lock(mutex_);
    for (const File& file : files_) files.push_back(&file);
  }
  check(files);
}

}  // namespace breakwater
