// `breakwater sweep`: studies of many runs.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// main() of the command; argv[0] is its name. Returns the exit status: 0 all points are done,
/// failed ones included; 1 a defect, 2 usage or input, 3 a run failed and the study is to stop
/// then, 130 interrupted.
int sweep_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
