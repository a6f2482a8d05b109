// The scenario for the catalogue: that of own_scenario.cpp, with its folder.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {
ScenarioKind own_scenario();
}

inline breakwater::ScenarioKind own_scenario_kind() {
  breakwater::ScenarioKind kind = breakwater::own_scenario();
  kind.folder = OWN_SCENARIO_FOLDER;
  return kind;
}
