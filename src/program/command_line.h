// The command line of a scenario: its own binary's, and that of `run NAME`.
#pragma once

#include <string>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// main() of a scenario; `video_program`, which has the command `video`, makes the videos of
/// --video. Returns its exit status: 0 success, 1 a defect of ours, 2 usage or input, 3 a run
/// failed, 4 only a video failed, 130 interrupted.
int scenario_main(const Catalogue& catalogue, const std::string& scenario,
                  const std::string& video_program, int argc, const char* const* argv);

}  // namespace breakwater
