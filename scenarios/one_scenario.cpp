// The main() of each scenario's own program.
#include <breakwater/program/scenario_program.h>

int main(int argc, char** argv) {
  return breakwater::scenario_program(argc, argv, breakwater::standard_catalogue(),
                                      BREAKWATER_SCENARIO);
}
