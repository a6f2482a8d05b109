// Observability of a pair (A, C): Eqs. 2.13 and 2.14.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// Rank of U_o = [C; C A; …; C Aⁿ⁻¹] ((p·n)×n), with balanced columns. The units of the states and
/// a short sampling period do not affect it. The pair is observable if the rank is n (Eq. 2.13).
Eigen::Index observability_rank(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C);

/// The smallest pivot of a matrix with at least as many columns as rows, relative to the largest.
double smallest_pivot(const Eigen::MatrixXd& matrix);

}  // namespace breakwater
