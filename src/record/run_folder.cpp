#include <breakwater/record/run_folder.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <tuple>

#include <breakwater/record/file_hash.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/record/process_name.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// A run that is incomplete or was replaced. It may be removed.
constexpr const char* kPartialMark = ".partial-";
// The earlier run, while it is replaced in two steps. It is always complete.
constexpr const char* kEarlierMark = ".earlier-";
// The file that proves an identification.
constexpr const char* kIdentified = "identified.json";

fs::path without_slash(const fs::path& folder) {
  const fs::path normal = fs::absolute(folder).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// A run, or an identification.
bool is_finished(const fs::path& folder) {
  return is_run_folder(folder) || fs::exists(folder / kIdentified);
}

// The suffixes of the folders beside the target with this mark.
std::vector<std::string> suffixes(const fs::path& target, const char* mark,
                                  const std::set<std::string>* beside) {
  const std::string begin = hidden_name(target, mark);
  std::set<std::string> own;
  if (beside == nullptr) own = hidden_names_in(target.parent_path());
  const std::set<std::string>& names = beside == nullptr ? own : *beside;
  std::vector<std::string> found;
  for (auto name = names.lower_bound(begin); name != names.end() && name->starts_with(begin);
       ++name) {
    found.push_back(name->substr(begin.size()));
  }
  return found;
}

void restore_earlier(const fs::path& target, const std::set<std::string>* beside) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(target, error))) return;
  fs::path latest;
  fs::file_time_type latest_time;
  for (const std::string& suffix : suffixes(target, kEarlierMark, beside)) {
    const fs::path earlier = target.parent_path() / (hidden_name(target, kEarlierMark) + suffix);
    // A process of another host may still be replacing the run. It then only fails to do so.
    const bool is_of_this_host = suffix.substr(0, suffix.rfind('-')) == host_name();
    const bool is_left = is_of_dead_process(suffix) || !is_of_this_host;
    if (!is_left || !is_finished(earlier)) continue;
    const fs::file_time_type time = fs::last_write_time(earlier / "manifest.json", error);
    if (latest.empty() || time > latest_time) {
      latest = earlier;
      latest_time = time;
    }
  }
  // Another process may have been faster.
  if (!latest.empty()) fs::rename(latest, target, error);
}

// The folders that threads of this process write, and the lock for making, swapping and removing
// folders.
std::mutex in_this_process;
std::set<fs::path> written_here;

// Files that the programs write into a run's folder, and their temporary files.
bool is_of_a_run(const std::string& name) {
  static const std::set<std::string> names = {
      "config.toml", "log.csv", "log.h5", "manifest.json", "metrics.json", "strip.png", "still.png",
      "video.mp4", "replay.html", "report.html", "measured.html", "compare.html", "compare.csv",
      "compare.tex", "compare.svg", "compare.pdf", kKept,
      // an identification's
      kIdentified, "identified.toml", "estimate.toml", "draws.csv", "sweep.toml", "tune.toml"};
  return names.contains(name) ||
         (name.starts_with('.') && name.find(".partial-") != std::string::npos);
}

// The reason why a run may not replace a folder; empty if it may.
std::string complaint_of(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return "is a file, not a folder";
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!is_of_a_run(name)) return "holds " + name + ", which is not a run's; it is left alone";
  }
  if (fs::is_empty(folder, error) || is_finished(folder)) return "";
  return "holds something that is not a run, or one whose manifest.json is damaged; it is left "
         "alone: delete it to go on";
}

// The new folder takes the place of the earlier one, which a process that works in it would lose.
bool is_working_folder(const fs::path& folder) {
  const fs::path here = fs::current_path(), there = fs::canonical(folder);
  return std::mismatch(there.begin(), there.end(), here.begin(), here.end()).first == there.end();
}

void remove_abandoned(const fs::path& target, const std::set<std::string>* left) {
  std::error_code ignored;
  const auto beside = [&](const char* mark, const std::string& suffix) {
    return target.parent_path() / (hidden_name(target, mark) + suffix);
  };
  for (const std::string& suffix : suffixes(target, kEarlierMark, left)) {
    const fs::path earlier = beside(kEarlierMark, suffix);
    if (!is_of_dead_process(suffix) || !complaint_of(earlier).empty()) continue;
    // An incomplete folder must not count as a run.
    fs::rename(earlier, beside(kPartialMark, suffix), ignored);
  }
  for (const std::string& suffix : suffixes(target, kPartialMark, left)) {
    const fs::path partial = beside(kPartialMark, suffix);
    if (is_of_dead_process(suffix) && !detail::is_locked(partial) && !is_kept(partial)) {
      fs::remove_all(partial, ignored);
    }
  }
}

[[noreturn]] void cannot_replace(const fs::path& target, const std::string& reason) {
  throw OutputError(target.string() + ": cannot be replaced (" + reason + ")");
}

// Swaps `partial` and `target`.
void exchange(const fs::path& partial, const fs::path& target) {
  if (renameat2(AT_FDCWD, partial.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
  // Some file systems cannot exchange.
  if (errno != EINVAL && errno != ENOSYS) cannot_replace(target, std::strerror(errno));
  // In two steps the target is missing for a moment. If this process is killed then, the next run
  // or reader restores the earlier run.
  const fs::path earlier =
      target.parent_path() / (hidden_name(target, kEarlierMark) + unique_name());
  std::error_code error;
  fs::rename(target, earlier, error);
  if (error) cannot_replace(target, error.message());
  fs::rename(partial, target, error);
  if (error) {
    std::error_code ignored;
    fs::rename(earlier, target, ignored);
    cannot_replace(target, error.message());
  }
  fs::rename(earlier, partial, error);
  if (error) cannot_replace(earlier, error.message());
}

// As exchange(), but the target may be missing.
void put_in_place(const fs::path& partial, const fs::path& target) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(target, error))) {
    fs::rename(partial, target, error);
    if (error) cannot_replace(target, error.message());
    return;
  }
  exchange(partial, target);
  // The target may have changed during the run.
  if (!complaint_of(partial).empty()) {
    exchange(partial, target);
    cannot_replace(target, "it holds something that is not a run; it is left alone");
  }
}

// Waits until a file, or the list of names in a folder, is on the disk.
void sync(const fs::path& path) {
  detail::DataFile(path, O_RDONLY).sync();
}

// Starts writing to the disk. The waits for one file after the other then take half the time.
void begin_writing(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  sync_file_range(descriptor, 0, 0, SYNC_FILE_RANGE_WRITE);
  close(descriptor);
}

void sync_all(const fs::path& folder) {
  std::error_code ignored;  // sync() reports it later
  const auto entries = [&] { return fs::recursive_directory_iterator(folder, ignored); };
  for (const auto& entry : entries()) begin_writing(entry.path());
  for (const auto& entry : entries()) sync(entry.path());
  sync(folder);
}

std::vector<fs::path> missing_parents(const fs::path& folder) {
  std::vector<fs::path> missing;
  for (fs::path p = folder; !fs::exists(p); p = p.parent_path()) missing.push_back(p);
  return missing;
}

// Innermost first. remove() refuses a folder that is not empty.
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

bool is_kept(const fs::path& folder) {
  std::error_code ignored;
  return is_unfinished_run(folder) && fs::exists(folder / kKept, ignored);
}

bool is_being_written(const fs::path& folder) {
  return is_unfinished_run(folder) && detail::is_locked(folder);
}

bool is_unfinished_run(const fs::path& folder) {
  const std::string name = without_slash(folder).filename().string();
  return name.starts_with('.') && name.find(kPartialMark) != std::string::npos;
}

std::set<std::string> hidden_names_in(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    std::string name = entry.path().filename().string();
    if (name.starts_with('.')) names.insert(std::move(name));
  }
  return names;
}

void read_whole(const fs::path& folder, const std::function<void()>& read) {
  constexpr int kMostTries = 200;
  constexpr std::chrono::milliseconds kPause(2);
  const fs::path target = followed(without_slash(folder));
  const auto identity = [&] {
    struct stat now = {};
    stat(target.c_str(), &now);  // all zeros without a folder
    return std::tuple(now.st_dev, now.st_ino, now.st_ctim.tv_sec, now.st_ctim.tv_nsec);
  };
  for (int tries = 1;; ++tries) {
    {
      const std::lock_guard lock(in_this_process);
      restore_earlier(target, nullptr);
    }
    const auto before = identity();
    try {
      read();
      if (identity() == before || tries == kMostTries) return;
    } catch (const std::invalid_argument&) {
      // A process that cannot exchange folders leaves none for a moment.
      const bool is_missing = before == decltype(before)() && identity() == before &&
                              !suffixes(target, kEarlierMark, nullptr).empty();
      if ((identity() == before && !is_missing) || tries == kMostTries) throw;
    }
    std::this_thread::sleep_for(kPause);
  }
}

bool check_file(const fs::path& folder, const char* file) {
  std::ifstream stream(folder / "manifest.json");
  const auto manifest = nlohmann::json::parse(stream, nullptr, false);
  const fs::path path = folder / file;
  const std::string key = path.stem().string() + "_hash";
  if (!manifest.is_object() || !manifest.contains(key)) return false;
  if (manifest[key] != file_hash(path)) {
    throw std::invalid_argument(path.string() +
                                ": is damaged: it is not what the run wrote; run it again");
  }
  return true;
}

void check_has_files(const fs::path& folder) {
  for (const char* file : {"config.toml", "log.h5"}) {
    std::error_code error;
    if (fs::file_size(folder / file, error) > 0 && !error) continue;
    throw std::invalid_argument(folder.string() + ": the run is incomplete: it has no " + file +
                                "; run it again");
  }
}

RunFolder::RunFolder(const fs::path& target, const std::set<std::string>* beside)
    : target_(followed(without_slash(target))) {
  const std::lock_guard lock(in_this_process);
  try {
    restore_earlier(target_, beside);
    if (fs::exists(target_)) {
      std::string complaint = complaint_of(target_);
      if (complaint.empty() && is_working_folder(target_)) {
        complaint = "is the working folder, or has it inside: name a folder of its own for the run";
      }
      if (!complaint.empty()) throw std::invalid_argument(target.string() + ": " + complaint);
    }
    made_parents_ = missing_parents(target_.parent_path());
    fs::create_directories(target_.parent_path());
    const fs::path parent = fs::canonical(target_.parent_path());
    written_ = parent / target_.filename();
    if (written_here.contains(written_)) {
      throw std::invalid_argument(target.string() +
                                  ": another thread of this process makes a run there: wait for "
                                  "it, or give another folder");
    }
    remove_abandoned(target_, beside);
    partial_ = parent / (hidden_name(target_, kPartialMark) + unique_name());
    if (!fs::create_directory(partial_)) {
      throw fs::filesystem_error("", std::make_error_code(std::errc::file_exists));
    }
    lock_ = std::make_unique<detail::DataFile>(partial_, O_RDONLY | O_DIRECTORY);
    lock_->lock();
    written_here.insert(written_);
  } catch (const fs::filesystem_error& error) {
    remove_empty(made_parents_);
    throw std::invalid_argument(target.string() + ": cannot be made (" + error.code().message() +
                                ")");
  }
}

RunFolder::~RunFolder() {
  const std::lock_guard lock(in_this_process);
  written_here.erase(written_);
  if (is_done_ || is_kept(partial_)) return;
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
  remove_empty(made_parents_);
}

void RunFolder::commit() {
  sync_all(partial_);
  try {
    const std::lock_guard lock(in_this_process);
    put_in_place(partial_, target_);
  } catch (const OutputError& error) {
    throw OutputError(error.what() + ("; the new run is kept in " + keep().string()));
  }
  is_done_ = true;
  sync(target_.parent_path());
  for (const fs::path& made : made_parents_) sync(made.parent_path());
  std::error_code ignored;
  fs::remove(target_ / kKept, ignored);
  fs::remove_all(partial_, ignored);
}

// Moves the finished run to a name that no later run removes, and returns this name.
fs::path RunFolder::keep() {
  is_done_ = true;
  std::error_code error;
  fs::path kept = target_.string() + ".kept";
  for (int n = 2; fs::exists(fs::symlink_status(kept, error)); ++n) {
    kept = target_.string() + ".kept-" + std::to_string(n);
  }
  fs::rename(partial_, kept, error);
  if (!error) return kept;
  std::ofstream(partial_ / kKept).flush();
  return partial_;
}

}  // namespace breakwater
