// The main() of one scenario alone.
#pragma once

#include <string>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// The catalogue of all that Breakwater brings with it: component `scenarios` has it.
Catalogue standard_catalogue();

namespace detail {
int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                     const std::string& scenario, const char* installation);

// Of the Breakwater that a program outside of its tree is built against: find_package() defines it.
#ifdef BREAKWATER_INSTALLATION
constexpr const char* kInstallation = BREAKWATER_INSTALLATION;
#else
constexpr const char* kInstallation = "";
#endif
}  // namespace detail

/// main() of a program of one scenario alone, the same as `run NAME`. Videos of its runs are made
/// by the program `breakwater` that stands beside it, so that this one loads no OpenGL and no
/// encoder. Returns its exit status, as program() does.
static inline int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                                   const std::string& scenario) {
  return detail::scenario_program(argc, argv, catalogue, scenario, detail::kInstallation);
}

}  // namespace breakwater
