// The scenario for the catalogue: its name, the function that makes it, and its folder.
#pragma once

#include <memory>

#include <breakwater/experiment/catalogue.h>

#include "own_scenario/own_scenario.h"

inline breakwater::ScenarioKind own_scenario_kind() {
  const auto make = [](const breakwater::Catalogue& catalogue) {
    return std::unique_ptr<breakwater::Scenario>(new breakwater::OwnScenario(catalogue));
  };
  return {"own_scenario", make, OWN_SCENARIO_FOLDER};
}
