#include <breakwater/experiment/known_models.h>

#include <stdexcept>

#include <breakwater/record/file_hash.h>
#include <breakwater/shell/paths.h>

namespace breakwater {
namespace {

struct stat status_of(const std::filesystem::path& file) {
  struct stat status = {};
  stat(file.c_str(), &status);  // all zeros if the file is gone
  return status;
}

bool is_same(const timespec& a, const timespec& b) {
  return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

// No program can set the time of the last status change. It reveals a copy.
bool is_untouched(const struct stat& then, const struct stat& now) {
  return is_same(then.st_mtim, now.st_mtim) && is_same(then.st_ctim, now.st_ctim) &&
         then.st_size == now.st_size;
}

}  // namespace

void KnownModels::note(const std::string& file) {
  const std::lock_guard lock(mutex_);
  noted(file);
}

const KnownModels::Files& KnownModels::noted(const std::string& file) {
  const auto found = models_.find(file);
  if (found != models_.end()) return found->second;
  const std::vector<std::filesystem::path> paths = model_paths({file});
  if (paths.empty()) throw std::invalid_argument(file + ": cannot be read");
  Files files;
  for (const auto& path : paths) {
    auto known = files_.find(path);
    if (known == files_.end()) {
      const struct stat status = status_of(path);
      known = files_.emplace(path, File{path, status, file_hash(path)}).first;
    }
    files.push_back(&known->second);
  }
  return models_.emplace(file, std::move(files)).first->second;
}

const ModelHashes& KnownModels::of(const std::vector<std::string>& files) {
  const std::lock_guard lock(mutex_);
  const auto found = hashes_.find(files);
  if (found != hashes_.end()) return found->second;
  ModelHashes hashes;
  for (const std::string& model : files) {
    for (const File* file : noted(model)) hashes[portable_path(file->path)] = file->hash;
  }
  return hashes_.emplace(files, std::move(hashes)).first->second;
}

void KnownModels::check(const File& file) {
  if (is_untouched(file.status, status_of(file.path)) || file_hash(file.path) == file.hash) return;
  throw std::invalid_argument(file.path.string() + ": was changed while it ran: start again");
}

void KnownModels::check_unchanged(const std::vector<std::string>& files) const {
  std::vector<const File*> all;
  {
    const std::lock_guard lock(mutex_);
    for (const std::string& model : files) {
      const auto found = models_.find(model);
      if (found != models_.end()) all.insert(all.end(), found->second.begin(), found->second.end());
    }
  }
  for (const File* file : all) check(*file);
}

void KnownModels::check_unchanged() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [path, file] : files_) check(file);
}

}  // namespace breakwater
