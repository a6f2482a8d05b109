#include "scenario/command_line.h"

int main(int argc, char** argv) {
  return breakwater::scenario_main("motor_estimation", argc, argv);
}
