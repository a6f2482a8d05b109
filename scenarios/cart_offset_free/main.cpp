#include "scenario/command_line.h"

int main(int argc, char** argv) {
  return breakwater::scenario_main("cart_offset_free", argc, argv);
}
