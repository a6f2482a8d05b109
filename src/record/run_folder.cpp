#include "record/run_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
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

// A run that was killed leaves its partial folder; the process' number in its name tells whether
// anybody still writes there.
void remove_abandoned(const fs::path& target) {
  const std::string prefix = "." + target.filename().string() + kPartialMark;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(target.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    pid_t pid = 0;
    const char* const begin = name.data() + prefix.size();
    std::from_chars(begin, name.data() + name.size(), pid);
    if (pid > 0 && kill(pid, 0) != 0 && errno == ESRCH) fs::remove_all(entry.path(), ignored);
  }
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
      if (!fs::is_empty(target_) && !is_run_folder(target_)) {
        throw std::invalid_argument(target.string() +
                                    ": holds something that is not a run; it is left alone");
      }
    }
    made_parents_ = missing_parents(target_.parent_path());
    fs::create_directories(target_.parent_path());
    remove_abandoned(target_);
    partial_ = target_.parent_path() /
               ("." + target_.filename().string() + kPartialMark + std::to_string(getpid()));
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
  if (fs::exists(target_)) {
    if (renameat2(AT_FDCWD, partial_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) != 0) {
      throw OutputError(target_.string() + ": cannot be replaced (" + std::strerror(errno) + ")");
    }
    committed_ = true;
    std::error_code ignored;
    fs::remove_all(partial_, ignored);
  } else {
    fs::rename(partial_, target_);
    committed_ = true;
  }
}

}  // namespace breakwater
