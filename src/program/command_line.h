// The command line of a scenario, in its own binary and in `run NAME`.
#pragma once

#include <string>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// main() of a scenario. The program `video_program` makes the videos of --video. Exit status: 0
/// success, 1 an internal error, 2 usage or input, 3 a run failed, 4 only a video failed, 130
/// interrupted.
int scenario_main(const Catalogue& catalogue, const std::string& scenario,
                  const std::string& video_program, int argc, const char* const* argv);

}  // namespace breakwater
