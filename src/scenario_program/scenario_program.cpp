#include <breakwater/scenario_program/scenario_program.h>

#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario_program/own_places.h>
#include <breakwater/scenario_program/run_extras.h>

namespace breakwater::detail {

int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                     const std::string& scenario, const char* installation) {
  set_places(catalogue, installation);
  return scenario_main(catalogue, scenario, run_extras(neighbour_program("breakwater")), argc,
                       argv);
}

}  // namespace breakwater::detail
