// `breakwater list`: what there is to choose from.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// main() of the command; argv[0] is its name. Returns its exit status.
int list_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
