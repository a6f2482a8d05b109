// Everything that `breakwater` does, over any catalogue: what a user's own program links.
#pragma once

#include <string>

#include <breakwater/scenario/catalogue.h>

namespace breakwater {

/// The catalogue of all that Breakwater brings with it: component `scenarios` has it.
Catalogue standard_catalogue();

/// main() of a program with all commands over the catalogue's scenarios: run, list, video, report,
/// reproduce, …. Returns its exit status: 0 success, 1 a defect, 2 usage or input, 3 a run failed,
/// 4 only a later output failed, 130 interrupted.
int program(int argc, const char* const* argv, const Catalogue& catalogue);

/// main() of a program of one scenario alone, the same as `run NAME`. Videos of its runs are made
/// by the program `breakwater` that stands beside it, so that this one loads no OpenGL and no
/// encoder.
int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                     const std::string& scenario);

}  // namespace breakwater
