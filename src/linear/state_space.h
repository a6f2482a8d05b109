// Linear time-invariant plants: their discretisation with a zero-order hold, and observability.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// An LTI plant ẋ = A x + B u, y = C x (Eqs. 2.2, 2.3) or, sampled, x(k+1) = A x(k) + B u(k) (Eqs.
/// 2.16, 2.17). The name of a variable says which one it is.
struct StateSpace {
  Eigen::MatrixXd A;  ///< n×n
  Eigen::MatrixXd B;  ///< n×m
  Eigen::MatrixXd C;  ///< p×n

  Eigen::Index states() const { return A.rows(); }
  Eigen::Index inputs() const { return B.cols(); }
  Eigen::Index outputs() const { return C.rows(); }
};

/// Throws std::invalid_argument unless the shapes of A, B and C fit and every entry is finite.
void check(const StateSpace& plant);

/// Exact discretisation with an input held over `period_s` [s], by the matrix exponential of [A B;
/// 0 0]·T_s (Van Loan). Throws std::invalid_argument if the period is not positive.
StateSpace zero_order_hold(const StateSpace& continuous, double period_s);

/// Extends a plant by one step-type disturbance per input (ḋ = 0, Eq. 2.4). The result has
/// Ā = [A −B; 0 0], B̄ = [B; 0], C̄ = [C 0] (Eqs. 2.9, 2.10, 2.54, 2.55).
StateSpace extend_by_input_disturbance(const StateSpace& continuous);

/// Rank of U_o = [C; C A; …; C Aⁿ⁻¹] ((p·n)×n), with balanced columns. The units of the states and
/// a short sampling period do not affect it. The pair is observable if the rank is n
/// (Eqs. 2.13, 2.14).
Eigen::Index observability_rank(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C);

/// Throws std::invalid_argument unless the extended plant of a `design` is observable. The message
/// has the rank.
void check_observable(const char* design, const Eigen::MatrixXd& A, const Eigen::MatrixXd& C);

}  // namespace breakwater
