// The discrete algebraic Riccati equation and the linear quadratic regulator.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// The stabilising solution P (n×n, symmetric, positive semidefinite) of
///     P = Aᵀ P A − Aᵀ P B (R + Bᵀ P B)⁻¹ Bᵀ P A + Q
/// by the structured doubling algorithm: its step k covers 2ᵏ samples. If it loses digits, or
/// leaves an unstable mode without weight in Q as it is, Newton's method follows on the balanced
/// plant. A solution counts only if each entry satisfies the equation, relative to the diagonal,
/// and the closed loop has no eigenvalue beyond 1 − 1e-9.
///
/// Sources: E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang, Int. J. Control 77 (2004) 767–788;
/// G. A. Hewer, IEEE Trans. Autom. Control 16 (1971) 382–384.
///
/// Throws std::invalid_argument unless the shapes fit, all entries are finite, Q is symmetric
/// positive semidefinite and R is symmetric positive definite. There must be a stabilising
/// solution: (A, B) is stabilisable, and Q has weight on all modes on the unit circle. The message
/// names the mode.
Eigen::MatrixXd solve_dare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                           const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R);

struct LqrDesign {
  Eigen::MatrixXd K;  ///< m×n: u = −K x
  Eigen::MatrixXd P;  ///< n×n: the future cost from x is xᵀ P x
};

/// The regulator of x(k+1) = A x(k) + B u(k) that minimises Σ xᵀ Q x + uᵀ R u over an infinite
/// horizon. Throws as solve_dare() does.
LqrDesign dlqr(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& R);

/// Whether a matrix is positive definite by more than rounding, and symmetric up to rounding.
bool is_positive_definite(const Eigen::MatrixXd& matrix);

/// Whether a matrix is positive semidefinite and symmetric, up to rounding. Units do not matter.
bool is_positive_semidefinite(const Eigen::MatrixXd& matrix);

}  // namespace breakwater
