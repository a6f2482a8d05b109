// The scenario motor_estimation on an identified axis.
#pragma once

#include <breakwater/recorded/identified_scenario.h>

namespace breakwater {

/// The delay becomes whole samples of the sensor. The gains of the controller and half the largest
/// torque as the step of the disturbance fit the plant.
IdentifiedScenarioKind identified_motor();

}  // namespace breakwater
