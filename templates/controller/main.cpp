// The `breakwater` program with one more controller of the arm.
#include <breakwater/program/program.h>

#include "my_controller.h"

int main(int argc, char** argv) {
  breakwater::Catalogue catalogue = breakwater::standard_catalogue();
  catalogue.add(my_controller_lab::my_controller_kind());
  return breakwater::program(argc, argv, catalogue);
}
