// The `breakwater` program with one more scenario.
#include <breakwater/program/program.h>

#include "my_scenario/my_scenario.h"

int main(int argc, char** argv) {
  breakwater::Catalogue catalogue = breakwater::standard_catalogue();
  catalogue.add(my_scenario_lab::my_scenario_kind());
  return breakwater::program(argc, argv, catalogue);
}
