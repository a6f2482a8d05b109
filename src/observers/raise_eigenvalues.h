// What a covariance that lost its definiteness by rounding is made definite by.
#pragma once

#include <Eigen/Core>

namespace breakwater {

constexpr int kMostStates = 32;  ///< of a covariance whose eigenvalues are raised

/// Raises the eigenvalues of a symmetric n×n matrix, n ≤ kMostStates, to `floor` times the largest
/// where they are less. It reads the lower triangle; both are written. Allocates nothing.
void raise_eigenvalues(Eigen::Ref<Eigen::MatrixXd> matrix, double floor);

}  // namespace breakwater
