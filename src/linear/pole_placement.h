// Pole placement for multi-output observers.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace breakwater {

/// The poles that one output is to place. A complex pole stands beside its conjugate.
using PoleGroup = std::vector<std::complex<double>>;

/// Observer gain H (n×p) with eig(A − H C) = the union of `groups`.
///
/// Group i holds the poles that output i places, so there are p groups with n poles in all. Each
/// pole λ of group i gets the left eigenvector w with wᵀ(A − λ I) = e_iᵀ C; then Hᵀ W = V, where
/// the columns of V are the e_i. On a plant made of decoupled chains, one per output, this gives
/// each chain its own group and leaves the chains decoupled (the joints of Eq. 2.54). A pole that
/// stands m times in one group gets a Jordan chain of length m.
///
/// Source: eigenstructure assignment, B. C. Moore, IEEE Trans. Autom. Control 21 (1976) 689–692.
///
/// Throws std::invalid_argument if the shapes do not fit, a pole is not finite or lacks its
/// conjugate, a pole already is an eigenvalue of A, or the groups cannot be placed through those
/// outputs (in particular, if (A, C) is not observable).
Eigen::MatrixXd place_observer_poles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                     const std::vector<PoleGroup>& groups);

/// z = e^{s T_s}: where a sampled system must put a continuous pole s [1/s]. Throws
/// std::invalid_argument unless each lies left of the imaginary axis, as those of an observer must.
std::vector<PoleGroup> sample_poles(const std::vector<PoleGroup>& continuous, double period_s);

/// The eigenvalues of a real square matrix.
PoleGroup eigenvalues(const Eigen::MatrixXd& A);

/// The largest magnitude of an eigenvalue.
double spectral_radius(const Eigen::MatrixXd& A);

}  // namespace breakwater
