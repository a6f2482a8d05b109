#include "program/program.h"
#include "standard.h"

int main(int argc, char** argv) {
  return breakwater::program(argc, argv, breakwater::standard_catalogue());
}
