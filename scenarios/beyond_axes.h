// Further parts of the catalogue of all scenarios, beyond those of the axes.
#pragma once

#include <breakwater/recorded/identified_scenario.h>

namespace breakwater {

/// The scenario motor_estimation on an identified axis. The delay is that of the command to the
/// drive. The gains of the controller and half the largest torque as the step of the disturbance
/// fit the plant. A tuning searches these gains and the process noise of a disturbance Kalman
/// filter.
IdentifiedScenarioKind identified_motor();

/// The scenario two_inertia on an identified motor and load. The constant torque of the records is
/// left out: the scenario has none. The gains, the poles and the observer's noise fit the plant.
/// The task is the reversal, which has the backlash.
IdentifiedTwoInertiaKind identified_two_inertia();

}  // namespace breakwater
