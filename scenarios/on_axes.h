// The scenarios of one axis.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

ScenarioKind cart_constrained();
ScenarioKind cart_estimation();
ScenarioKind cart_offset_free();
ScenarioKind cart_position();
ScenarioKind motor_estimation();
ScenarioKind two_inertia();

}  // namespace breakwater
