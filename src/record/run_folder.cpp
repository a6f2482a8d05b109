#include "record/run_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <system_error>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPartialMark = ".partial-";

std::string host_name() {
  std::array<char, HOST_NAME_MAX + 1> name = {};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string partial_prefix(const fs::path& target) {
  return "." + target.filename().string() + kPartialMark + host_name() + "-";
}

// A run that was killed leaves its partial folder; the process' number in its name tells whether
// anybody still writes there. This process' own number is one that was given out again.
void remove_abandoned(const fs::path& target) {
  const std::string prefix = partial_prefix(target);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(target.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    pid_t pid = 0;
    const char* const begin = name.data() + prefix.size();
    std::from_chars(begin, name.data() + name.size(), pid);
    const bool is_gone = pid > 0 && kill(pid, 0) != 0 && errno == ESRCH;
    if (is_gone || pid == getpid()) fs::remove_all(entry.path(), ignored);
  }
}

bool may_be_replaced(const fs::path& folder) {
  return fs::is_directory(folder) && (fs::is_empty(folder) || is_run_folder(folder));
}

[[noreturn]] void cannot_replace(const fs::path& target, const std::string& reason) {
  throw OutputError(target.string() + ": cannot be replaced (" + reason + ")");
}

// Puts `partial` in the place of `target`, which is left at `partial`.
void exchange(const fs::path& partial, const fs::path& target) {
  if (renameat2(AT_FDCWD, partial.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
  // Not every file system can exchange; in two steps the target is missing for a moment.
  if (errno != EINVAL && errno != ENOSYS) cannot_replace(target, std::strerror(errno));
  const fs::path aside = partial.string() + ".old";
  std::error_code error;
  fs::rename(target, aside, error);
  if (!error) fs::rename(partial, target, error);
  if (!error) fs::rename(aside, partial, error);
  if (error) cannot_replace(target, error.message());
}

std::vector<fs::path> missing_parents(const fs::path& folder) {
  std::vector<fs::path> missing;
  for (fs::path p = folder; !fs::exists(p); p = p.parent_path()) missing.push_back(p);
  return missing;
}

// Innermost first; a folder with something else in it by now is refused by remove() and stays.
void remove_empty(const std::vector<fs::path>& folders) {
  std::error_code ignored;
  for (const fs::path& folder : folders) fs::remove(folder, ignored);
}

}  // namespace

bool is_run_folder(const fs::path& folder) {
  std::ifstream stream(folder / "manifest.json");
  const auto manifest = nlohmann::json::parse(stream, nullptr, false);
  return manifest.is_object() && manifest.contains("scenario") && manifest.contains("state_hash");
}

RunFolder::RunFolder(const fs::path& target) : target_(fs::absolute(target).lexically_normal()) {
  if (!target_.has_filename()) target_ = target_.parent_path();
  try {
    if (fs::exists(target_)) {
      if (!fs::is_directory(target_)) {
        throw std::invalid_argument(target.string() + ": is a file, not a folder");
      }
      if (!may_be_replaced(target_)) {
        throw std::invalid_argument(target.string() +
                                    ": holds something that is not a run; it is left alone");
      }
    }
    made_parents_ = missing_parents(target_.parent_path());
    fs::create_directories(target_.parent_path());
    remove_abandoned(target_);
    partial_ = target_.parent_path() / (partial_prefix(target_) + std::to_string(getpid()));
    fs::create_directory(partial_);
  } catch (const fs::filesystem_error& error) {
    remove_empty(made_parents_);
    throw std::invalid_argument(target.string() + ": cannot be made (" + error.code().message() +
                                ")");
  }
}

RunFolder::~RunFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
  remove_empty(made_parents_);
}

void RunFolder::commit() {
  std::error_code error;
  if (!fs::exists(target_)) {
    fs::rename(partial_, target_, error);
    if (error) cannot_replace(target_, error.message());
    committed_ = true;
    return;
  }
  exchange(partial_, target_);
  // What stood there may have become something else while the run went on.
  if (!may_be_replaced(partial_)) {
    exchange(partial_, target_);
    cannot_replace(target_, "it holds something that is not a run; it is left alone");
  }
  committed_ = true;
  fs::remove_all(partial_, error);
}

}  // namespace breakwater
