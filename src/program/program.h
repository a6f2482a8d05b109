// The program `breakwater` for any catalogue. A user's own program links it.
#pragma once

#include <breakwater/experiment/catalogue.h>
#include <breakwater/program/scenario_program.h>

namespace breakwater {

namespace detail {
int program(int argc, const char* const* argv, const Catalogue& catalogue,
            const char* installation);
}  // namespace detail

/// main() of a program with all commands: run, list, video, report, reproduce, …. Exit status: 0
/// success, 1 an internal error, 2 usage or input, 3 a run failed, 4 only a later output failed,
/// 130 interrupted.
static inline int program(int argc, const char* const* argv, const Catalogue& catalogue) {
  return detail::program(argc, argv, catalogue, detail::kInstallation);
}

}  // namespace breakwater
