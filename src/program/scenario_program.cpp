// Apart from program.cpp: what it links, a scenario's own binary does not load.
#include <breakwater/program/own_places.h>
#include <breakwater/program/program.h>
#include <breakwater/program/run_extras.h>
#include <breakwater/scenario/child_program.h>

namespace breakwater::detail {

int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                     const std::string& scenario, const char* installation) {
  set_places(catalogue, installation);
  return scenario_main(catalogue, scenario, run_extras(neighbour_program("breakwater")), argc,
                       argv);
}

}  // namespace breakwater::detail
