// Random plants.
#pragma once

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/linear/state_space.h>
#include "support.h"

namespace breakwater::testing {

/// A stable sampled plant with n states, m inputs and p outputs.
inline StateSpace random_plant(Random& random, Eigen::Index n, Eigen::Index m, Eigen::Index p) {
  Eigen::MatrixXd A = random.matrix(n, n);
  A *= random.uniform(0.5, 0.98) / spectral_radius(A);
  return {A, random.matrix(n, m), random.matrix(p, n)};
}

}  // namespace breakwater::testing
