// The scenario motor_estimation on an identified axis.
#pragma once

#include <breakwater/recorded/identified_scenario.h>

namespace breakwater {

/// The delay is that of the command to the drive. The gains of the controller and half the largest
/// torque as the step of the disturbance fit the plant. A tuning searches these gains and the
/// process noise of a disturbance Kalman filter.
IdentifiedScenarioKind identified_motor();

}  // namespace breakwater
