// The main() of a program with a single scenario.
#pragma once

#include <string>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Sets the search order of files: the folders of the catalogue's scenarios first, `installation`
/// last if not empty. Also tells the shell how to detect that a model is being compiled.
void set_places(const Catalogue& catalogue, const char* installation);

/// The catalogue of everything in Breakwater. The component `scenarios` contains it.
Catalogue standard_catalogue();

/// The part of it that needs no quadrotor and no recorded data. The component `axes_scenarios`
/// contains it, but not in a build without BREAKWATER_TOOLS.
Catalogue axes_catalogue();
/// The part of this that the scenarios of the planar arm name. Every build has it.
Catalogue arm_catalogue();

namespace detail {
int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                     const std::string& scenario, const char* installation);

// find_package() defines it for a program outside the tree: the installed Breakwater.
#ifdef BREAKWATER_INSTALLATION
constexpr const char* kInstallation = BREAKWATER_INSTALLATION;
#else
constexpr const char* kInstallation = "";
#endif
}  // namespace detail

/// main() of a program for one scenario, the same as `run NAME`. The program `breakwater` beside it
/// makes the videos, so this one loads neither OpenGL nor an encoder. Returns the exit status as
/// program() does.
static inline int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                                   const std::string& scenario) {
  return detail::scenario_program(argc, argv, catalogue, scenario, detail::kInstallation);
}

}  // namespace breakwater
