// `breakwater tune`: the best values of some keys, and what they are worth elsewhere.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// main() of the command; argv[0] is its name. Returns the exit status: 0 the tuning is done, 1 a
/// defect, 2 usage or input, 3 no candidate met the constraints or survived, 130 interrupted.
int tune_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
