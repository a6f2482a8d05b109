#include <breakwater/experiment/run_list.h>

#include <fmt/format.h>

#include <stdexcept>

#include <breakwater/experiment/run_manifest.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/record/run_folder.h>

namespace breakwater {
namespace fs = std::filesystem;

ListedFolder list_run(const fs::path& folder) {
  ListedFolder run{folder};
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
