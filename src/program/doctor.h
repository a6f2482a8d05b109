// `breakwater doctor`: what works on this machine, and what to install for what does not.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

inline constexpr const char* kDoctor = "doctor";

/// main() of the command; argv[0] is its name. Returns 0, or 1 if something is broken.
int doctor_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
