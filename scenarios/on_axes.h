// The scenarios of one axis.
#pragma once

#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

ScenarioKind cart_constrained();
ScenarioKind cart_estimation();
ScenarioKind cart_offset_free();
ScenarioKind cart_position();
ScenarioKind motor_estimation();
ScenarioKind two_inertia();

/// Keys of a reference that steps once.
void bind_step(Fields& fields, Reference& reference);

}  // namespace breakwater
