// Observability of a pair (A, C): Eqs. 2.13 and 2.14.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// Rank of U_o = [C; C A; …; C Aⁿ⁻¹] ((p·n)×n), counted on balanced columns: a state's unit or a
/// short sampling period does not change it. The pair is observable if it equals n (Eq. 2.13).
Eigen::Index observability_rank(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C);

}  // namespace breakwater
