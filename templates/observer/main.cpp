// Everything that `breakwater` does, with one estimator of an axis more.
#include <breakwater/program/program.h>

#include "my_observer.h"

int main(int argc, char** argv) {
  breakwater::Catalogue catalogue = breakwater::standard_catalogue();
  catalogue.add(my_observer_lab::my_observer_kind());
  return breakwater::program(argc, argv, catalogue);
}
