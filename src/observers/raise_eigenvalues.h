// Repair of a covariance that rounding has made indefinite.
#pragma once

#include <Eigen/Core>

namespace breakwater {

constexpr int kMostStates = 32;  ///< the largest n

/// Raises the eigenvalues of a symmetric n×n matrix, n ≤ kMostStates, to at least `floor` times the
/// largest one. Reads the lower triangle, writes both. Allocates nothing.
void raise_eigenvalues(Eigen::Ref<Eigen::MatrixXd> matrix, double floor);

}  // namespace breakwater
