// The input of a controller at a sampling instant.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// The sensors' values at one sampling instant. Each controller says which entries of `y` it
/// expects, and in which units. The rig connects the sensors accordingly.
struct Sample {
  double time_s = 0.0;
  Eigen::VectorXd y;
};

}  // namespace breakwater
