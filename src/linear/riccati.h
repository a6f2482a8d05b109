// The discrete algebraic Riccati equation and the linear quadratic regulator.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// The stabilising solution P (n×n, symmetric, positive semidefinite) of
///     P = Aᵀ P A − Aᵀ P B (R + Bᵀ P B)⁻¹ Bᵀ P A + Q
/// by the structured doubling algorithm: its k-th step has looked 2ᵏ samples ahead. If Q does not
/// see an unstable mode, so that leaving it alone is cheaper, by Newton's method.
///
/// Sources: E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang, Int. J. Control 77 (2004) 767–788;
/// G. A. Hewer, IEEE Trans. Autom. Control 16 (1971) 382–384.
///
/// Throws std::invalid_argument if the shapes do not fit, an entry is not finite, Q is not
/// symmetric positive semidefinite, R is not symmetric positive definite, or there is no
/// stabilising solution ((A, B) not stabilisable, or a mode on the unit circle that Q does not
/// see).
Eigen::MatrixXd solve_dare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                           const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R);

struct LqrDesign {
  Eigen::MatrixXd K;  ///< m×n: u = −K x
  Eigen::MatrixXd P;  ///< n×n: what the future costs from x is xᵀ P x
};

/// The regulator of x(k+1) = A x(k) + B u(k) that minimises Σ xᵀ Q x + uᵀ R u over an infinite
/// horizon. Errors as solve_dare.
LqrDesign dlqr(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& R);

/// Whether a matrix is symmetric to rounding and positive definite.
bool is_positive_definite(const Eigen::MatrixXd& matrix);

/// Whether a matrix is symmetric to rounding and positive semidefinite to rounding.
bool is_positive_semidefinite(const Eigen::MatrixXd& matrix);

}  // namespace breakwater
