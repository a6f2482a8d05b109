#include <breakwater/program/scenario_program.h>

#include <breakwater/program/command_line.h>
#include <breakwater/program/own_places.h>
#include <breakwater/shell/child_program.h>

namespace breakwater::detail {

int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                     const std::string& scenario, const char* installation) {
  set_places(catalogue, installation);
  return scenario_main(catalogue, scenario, neighbour_program("breakwater"), argc, argv);
}

}  // namespace breakwater::detail
