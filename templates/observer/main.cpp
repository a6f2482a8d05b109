// The `breakwater` program with one more estimator of an axis.
#include <breakwater/program/program.h>

#include "my_observer.h"

int main(int argc, char** argv) {
  breakwater::Catalogue catalogue = breakwater::standard_catalogue();
  catalogue.add(my_observer_lab::my_observer_kind());
  return breakwater::program(argc, argv, catalogue);
}
