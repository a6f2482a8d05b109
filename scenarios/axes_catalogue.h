// The scenarios on axes.
#pragma once

#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/scenario.h>

namespace breakwater {

ScenarioKind arm_push();
ScenarioKind arm_wall_contact();
ScenarioKind cart_constrained();
ScenarioKind cart_estimation();
ScenarioKind cart_offset_free();
ScenarioKind impact_test();
ScenarioKind two_inertia();

/// The reductions of arm_push's metrics.
std::vector<MetricKind> kinds_of_a_push();

}  // namespace breakwater
