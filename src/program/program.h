// Everything that `breakwater` does, over any catalogue: what a user's own program links.
#pragma once

#include <string>

#include <breakwater/scenario/catalogue.h>

namespace breakwater {

/// The catalogue of all that Breakwater brings with it: component `scenarios` has it.
Catalogue standard_catalogue();

namespace detail {
int program(int argc, const char* const* argv, const Catalogue& catalogue,
            const char* installation);
int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                     const std::string& scenario, const char* installation);

// Of the Breakwater that a program outside of its tree is built against: find_package() defines it.
#ifdef BREAKWATER_INSTALLATION
constexpr const char* kInstallation = BREAKWATER_INSTALLATION;
#else
constexpr const char* kInstallation = "";
#endif
}  // namespace detail

/// main() of a program with all commands over the catalogue's scenarios: run, list, video, report,
/// reproduce, …. Returns its exit status: 0 success, 1 a defect, 2 usage or input, 3 a run failed,
/// 4 only a later output failed, 130 interrupted.
static inline int program(int argc, const char* const* argv, const Catalogue& catalogue) {
  return detail::program(argc, argv, catalogue, detail::kInstallation);
}

/// main() of a program of one scenario alone, the same as `run NAME`. Videos of its runs are made
/// by the program `breakwater` that stands beside it, so that this one loads no OpenGL and no
/// encoder.
static inline int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                                   const std::string& scenario) {
  return detail::scenario_program(argc, argv, catalogue, scenario, detail::kInstallation);
}

}  // namespace breakwater
