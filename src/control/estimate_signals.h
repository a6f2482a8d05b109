// The estimates of an axis as signals for a log.
#pragma once

#include <vector>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/signals/axis_units.h>

namespace breakwater {

/// Position, velocity and disturbance of an estimator with the states [q, v] or, for two inertias,
/// [q, v, q₂, v₂].
std::vector<Signal> estimate_signals(const DisturbanceEstimator& estimator, const AxisUnits& units);

}  // namespace breakwater
