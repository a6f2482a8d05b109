// A plant with a second output that measures nothing.
#pragma once

#include <breakwater/observers/disturbance_model.h>

namespace breakwater::testing {

inline StateSpace with_idle_output(StateSpace plant) {
  plant.C.conservativeResize(2, Eigen::NoChange);
  plant.C.row(1).setZero();
  return plant;
}

/// The second output is always 0. A filter of two outputs then has the estimates of the first one
/// alone, but computes them with matrix products.
inline ExtendedPlant with_idle_output(ExtendedPlant plant) {
  plant.sampled = with_idle_output(plant.sampled);
  if (plant.continuous) plant.continuous = with_idle_output(*plant.continuous);
  return plant;
}

}  // namespace breakwater::testing
