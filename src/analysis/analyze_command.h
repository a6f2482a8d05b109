// The command `analyze`.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

inline constexpr const char* kAnalyze = "analyze";

/// `PROGRAM analyze SCENARIO [OPTION...]`: loops of one axis in the frequency domain. Returns the
/// exit status. argv[0] is the command's name.
int analyze_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
