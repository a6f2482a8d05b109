// The scenario of a program and its catalogue, given by the build.
#include <breakwater/program/scenario_program.h>

namespace breakwater {

extern const char* const kScenario;
const char* const kScenario = BREAKWATER_SCENARIO;

Catalogue catalogue_of_scenario();
Catalogue catalogue_of_scenario() {
  return BREAKWATER_CATALOGUE();
}

}  // namespace breakwater
