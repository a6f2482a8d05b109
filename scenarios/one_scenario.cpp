// The main() of each scenario's own program, compiled once.
#include <breakwater/program/scenario_program.h>

namespace breakwater {
extern const char* const kScenario;  // scenario_name.cpp
}

int main(int argc, char** argv) {
  return breakwater::scenario_program(argc, argv, breakwater::standard_catalogue(),
                                      breakwater::kScenario);
}
