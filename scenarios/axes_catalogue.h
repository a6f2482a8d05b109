// The scenarios on axes.
#pragma once

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/scenario.h>

namespace breakwater {

ScenarioKind arm_push();
ScenarioKind arm_wall_contact();
ScenarioKind cart_constrained();
ScenarioKind cart_estimation();
ScenarioKind impact_test();
ScenarioKind two_inertia();

}  // namespace breakwater
