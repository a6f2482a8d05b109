// main() of a program with one external scenario.
#include <breakwater/program/scenario_program.h>

#include "own_scenario_kind.h"

int main(int argc, char** argv) {
  breakwater::Catalogue catalogue = breakwater::standard_catalogue();
  catalogue.add(own_scenario_kind());
  return breakwater::scenario_program(argc, argv, catalogue, "own_scenario");
}
