// The command `analyze`.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

inline constexpr const char* kAnalyze = "analyze";

/// `PROGRAM analyze SCENARIO|FILE.toml [OPTION...]`: frequency responses of loops of one axis.
/// argv[0] is the command's name. Returns the exit status.
int analyze_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
