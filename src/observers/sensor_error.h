// What is known of a sensor's error.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// Of each output, in its unit.
struct SensorError {
  Eigen::VectorXd quantum;    ///< Δ, what one count of an encoder is worth; 0: not quantised
  Eigen::VectorXd noise_std;  ///< σ, of white noise
};

/// Throws std::invalid_argument unless both have one finite entry ≥ 0 for each of p outputs.
void check(const SensorError& error, Eigen::Index outputs);

}  // namespace breakwater
