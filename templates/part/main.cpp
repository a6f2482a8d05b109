// The `breakwater` program with one more part.
#include <breakwater/program/program.h>

#include "my_part.h"

int main(int argc, char** argv) {
  breakwater::Catalogue catalogue = breakwater::standard_catalogue();
  catalogue.add(my_part_lab::my_part_kind());
  return breakwater::program(argc, argv, catalogue);
}
