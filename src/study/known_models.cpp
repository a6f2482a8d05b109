#include <breakwater/study/known_models.h>

#include <stdexcept>

#include <breakwater/record/file_hash.h>
#include <breakwater/scenario/paths.h>

namespace breakwater {
namespace {

struct stat status_of(const std::filesystem::path& file) {
  struct stat status = {};
  stat(file.c_str(), &status);  // all zeros if it is gone
  return status;
}

bool is_same(const timespec& a, const timespec& b) {
  return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

// The time of the last change of status, which nobody can set, tells of a copy that kept its time.
bool is_untouched(const struct stat& then, const struct stat& now) {
  return is_same(then.st_mtim, now.st_mtim) && is_same(then.st_ctim, now.st_ctim) &&
         then.st_size == now.st_size;
}

}  // namespace

const ModelHashes& KnownModels::of(const std::vector<std::string>& files) {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(files);
  if (found != known_.end()) return found->second.hashes;
  Known known;
  for (const auto& path : model_paths(files)) {
    const struct stat status = status_of(path);
    known.files.push_back({path, status, file_hash(path)});
    known.hashes[portable_path(path)] = known.files.back().hash;
  }
  return known_.emplace(files, std::move(known)).first->second.hashes;
}

void KnownModels::check(const Known& known) {
  for (const File& file : known.files) {
    if (is_untouched(file.status, status_of(file.path)) || file_hash(file.path) == file.hash) {
      continue;
    }
    throw std::invalid_argument(file.path.string() + ": was changed while it ran: start again");
  }
}

void KnownModels::check_unchanged(const std::vector<std::string>& files) const {
  const Known* known = nullptr;
  {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(files);
    if (found != known_.end()) known = &found->second;
  }
  if (known != nullptr) check(*known);
}

void KnownModels::check_unchanged() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [files, known] : known_) check(known);
}

}  // namespace breakwater
