// Predicted trajectories of a linear plant as functions of future input changes: Eq. 2.43.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// The states of the next N_p samples, stacked. They depend on the state x(k), the input u(k−1) and
/// the input changes ΔU = [Δu(k); …; Δu(k + N_u − 1)], after which the input is constant:
///     Z = [x(k+1); …; x(k + N_p)] = Ψ x(k) + Γ u(k−1) + Θ ΔU.
struct Prediction {
  Eigen::MatrixXd Psi;    ///< N_p n × n: A, A², …
  Eigen::MatrixXd Gamma;  ///< N_p n × m: B, A B + B, … = S_1, S_2, …
  Eigen::MatrixXd Theta;  ///< N_p n × N_u m: block (i, j) is S_{i−j+1}, or 0 above the diagonal
};

/// The prediction for x(k+1) = A x(k) + B u(k). Throws std::invalid_argument unless the shapes fit
/// and 1 ≤ N_u ≤ N_p.
Prediction predict(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, int prediction_steps,
                   int control_steps);

}  // namespace breakwater
