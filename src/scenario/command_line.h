// The command line of a scenario: its own binary's, and that of `run NAME`.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <breakwater/scenario/catalogue.h>
#include <breakwater/scenario/report.h>

namespace breakwater {

/// What other rooms add to a run.
struct RunExtras {
  std::string video_program;  ///< the name of the one that has the command `video`
  /// --video: makes the video of the run in a folder, `file` or, if that is empty, its default.
  /// Prints one line if it fails. Returns an exit status.
  std::function<int(const std::filesystem::path& folder, const std::string& file, bool quiet)>
      make_video;
  References references;
};

/// main() of a scenario. Returns its exit status: 0 success, 1 a defect of ours, 2 usage or input,
/// 3 a run failed, 4 only a video failed, 130 interrupted.
int scenario_main(const Catalogue& catalogue, const std::string& scenario, const RunExtras& extras,
                  int argc, const char* const* argv);

}  // namespace breakwater
