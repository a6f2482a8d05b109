#include <breakwater/program/program.h>

int main(int argc, char** argv) {
  return breakwater::program(argc, argv, breakwater::standard_catalogue());
}
