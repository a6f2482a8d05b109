// `breakwater ls` and `breakwater rm`: the runs and studies below a folder.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

inline constexpr const char* kListRuns = "ls";
inline constexpr const char* kRemoveRuns = "rm";

/// main() of each command; argv[0] is its name. Each returns its exit status.
int list_runs_main(const Catalogue& catalogue, int argc, const char* const* argv);
int remove_runs_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
