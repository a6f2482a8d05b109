// main() of each scenario's own binary.
#include "program/program.h"
#include "standard.h"

int main(int argc, char** argv) {
  return breakwater::scenario_program(argc, argv, breakwater::standard_catalogue(),
                                      BREAKWATER_SCENARIO);
}
