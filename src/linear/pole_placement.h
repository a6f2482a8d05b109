// Pole placement for multi-output observers.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace breakwater {

/// The poles that one output places. A complex pole needs its conjugate.
using PoleGroup = std::vector<std::complex<double>>;

/// Observer gain H (n×p). eig(A − H C) is the union of `groups`.
///
/// Output i places the poles of group i: p groups with n poles in all. Each pole λ of group i gets
/// the left eigenvector w with wᵀ(A − λ I) = e_iᵀ C. Then Hᵀ W = V, where the columns of V are the
/// e_i. For a plant of decoupled chains, one per output, each chain gets its own group, and the
/// chains stay decoupled (the joints of Eq. 2.54). A pole that occurs m times in one group gets a
/// Jordan chain of length m. One output has only one gain, and Ackermann's formula checks it.
///
/// Sources: eigenstructure assignment, B. C. Moore, IEEE Trans. Autom. Control 21 (1976) 689–692;
/// J. Ackermann, Regelungstechnik 20 (1972) 297–300.
///
/// Throws std::invalid_argument if the shapes do not fit, or a pole is not finite or lacks its
/// conjugate. Throws it too if the outputs cannot place the groups, for example if (A, C) is not
/// observable.
Eigen::MatrixXd place_observer_poles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                     const std::vector<PoleGroup>& groups);

/// The poles z = e^{s T_s} of a sampled system, from continuous poles s [1/s]. Throws
/// std::invalid_argument unless all s are left of the imaginary axis.
std::vector<PoleGroup> sample_poles(const std::vector<PoleGroup>& continuous, double period_s);

}  // namespace breakwater
