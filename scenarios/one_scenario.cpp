// The main() of a scenario's own program. The build gives the scenario and its catalogue.
#include <breakwater/program/scenario_program.h>

int main(int argc, char** argv) {
  return breakwater::scenario_program(argc, argv, breakwater::BREAKWATER_CATALOGUE(),
                                      BREAKWATER_SCENARIO);
}
