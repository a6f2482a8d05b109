// The command line of all scenario binaries.
#pragma once

#include <string>

namespace breakwater {

/// main() of a scenario binary. Returns its exit status: 0 success, 1 a defect of ours, 2 usage or
/// input, 3 a run failed, 130 interrupted.
int scenario_main(const std::string& scenario, int argc, const char* const* argv);

}  // namespace breakwater
