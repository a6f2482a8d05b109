// What a controller is given at one sampling instant.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// The sensors' values at one sampling instant. Which entry of `y` is which channel, and in what
/// unit, is fixed by whoever wires sensors to a controller; each controller says what it expects.
struct Sample {
  double time_s = 0.0;
  Eigen::VectorXd y;
};

}  // namespace breakwater
