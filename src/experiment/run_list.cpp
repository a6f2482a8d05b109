#include <breakwater/experiment/run_list.h>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/experiment/run_manifest.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/record/run_folder.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

void look_into(const fs::path& folder, const std::function<bool(const fs::path&)>& is_other,
               FoundRuns& found) {
  if (is_other(folder)) {
    found.others.push_back(folder);
    return;
  }
  std::error_code error;
  if (fs::exists(folder / "manifest.json", error)) {
    found.runs.push_back(folder);
    return;
  }
  // A folder that cannot be read, or vanishes meanwhile, counts as empty.
  std::vector<fs::path> folders;
  for (fs::directory_iterator entries(folder, error), end; !error && entries != end;
       entries.increment(error)) {
    std::error_code ignored;
    const fs::directory_entry& entry = *entries;
    if (entry.is_directory(ignored) && !entry.is_symlink(ignored)) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  for (const fs::path& inner : folders) {
    if (is_unfinished_run(inner)) {
      found.unfinished.push_back(inner);
    } else if (!inner.filename().string().starts_with('.')) {
      look_into(inner, is_other, found);
    }
  }
}

}  // namespace

FoundRuns find_runs(const fs::path& below, const std::function<bool(const fs::path&)>& is_other) {
  if (!fs::is_directory(below)) {
    throw std::invalid_argument(below.string() + (fs::exists(below) ? ": is a file, not a folder"
                                                                    : ": there is no such folder"));
  }
  FoundRuns found;
  look_into(below, is_other, found);
  return found;
}

ListedRun list_run(const fs::path& folder) {
  ListedRun run;
  run.folder = folder;
  std::error_code ignored;
  // The manifest's time is no use: drawing a picture changes it.
  run.written = fs::last_write_time(folder / "log.h5", ignored);
  if (ignored) run.written = fs::last_write_time(folder / "manifest.json", ignored);
  const auto read = [&] {
    const RunManifest manifest = read_manifest(folder);
    check_has_files(folder);
    run.scenario = manifest.scenario;
    run.case_name = manifest.case_name;
    run.seed = manifest.seed;
    if (manifest.failure) {
      const Failure& failure = *manifest.failure;
      run.status = failure.is_cut ? "cut" : "failed";
      run.reason = failure.is_cut ? failure.reason
                                  : fmt::format("at {:.6g} s: {}", failure.time_s, failure.reason);
      if (manifest.is_unfinished && is_being_written(folder)) {
        run.status = kRunning;
        run.reason = "";
      }
    } else {
      run.metrics = read_metrics(folder);
      run.status = "complete";
    }
  };
  try {
    read_whole(folder, read);
  } catch (const std::invalid_argument& error) {
    run.reason = error.what();
  }
  return run;
}

}  // namespace breakwater
