#include "scenario/command_line.h"

int main(int argc, char** argv) {
  return breakwater::scenario_main("quadrotor_waves", argc, argv);
}
