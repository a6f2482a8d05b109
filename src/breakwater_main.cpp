#include "scenario/command_line.h"

int main(int argc, char** argv) {
  return breakwater::breakwater_main(argc, argv);
}
