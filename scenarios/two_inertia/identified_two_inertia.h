// The scenario two_inertia on an identified motor and load.
#pragma once

#include <breakwater/recorded/identified_scenario.h>

namespace breakwater {

/// The constant torque of the records is left out: the scenario has none. The gains, the poles and
/// the observer's noise fit the plant. The task is the reversal, which has the backlash.
IdentifiedTwoInertiaKind identified_two_inertia();

}  // namespace breakwater
