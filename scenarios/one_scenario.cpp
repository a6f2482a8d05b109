// The main() of each scenario's own program, compiled once.
#include <breakwater/program/scenario_program.h>

namespace breakwater {
extern const char* const kScenario;  // scenario_name.cpp
Catalogue catalogue_of_scenario();   // the same
}  // namespace breakwater

int main(int argc, char** argv) {
  return breakwater::scenario_program(argc, argv, breakwater::catalogue_of_scenario(),
                                      breakwater::kScenario);
}
