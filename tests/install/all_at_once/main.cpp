#include <breakwater/program/program.h>

#include "own_controller/own_controller.h"
#include "own_observer/own_observer.h"
#include "own_scenario_kind.h"

int main(int argc, char** argv) {
  breakwater::Catalogue catalogue = breakwater::standard_catalogue();
  catalogue.add(own_controller_lab::own_controller_kind());
  catalogue.add(own_observer_lab::own_observer_kind());
  catalogue.add(own_scenario_kind());
  return breakwater::program(argc, argv, catalogue);
}
