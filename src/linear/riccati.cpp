#include "linear/riccati.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr int kMostDoublings = 60;
constexpr double kConverged = 1e-14;        // relative change of P
constexpr double kSymmetric = 1e-12;        // relative
constexpr double kSmallestResidual = 1e-8;  // relative; above, the doubling has not converged

bool is_symmetric(const Eigen::MatrixXd& matrix) {
  return matrix.rows() == matrix.cols() && matrix.allFinite() &&
         (matrix - matrix.transpose()).norm() <= kSymmetric * matrix.norm();
}

Eigen::MatrixXd symmetric_part(const Eigen::MatrixXd& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

}  // namespace

bool is_positive_definite(const Eigen::MatrixXd& matrix) {
  return matrix.size() > 0 && is_symmetric(matrix) &&
         Eigen::LLT<Eigen::MatrixXd>(matrix).info() == Eigen::Success;
}

bool is_positive_semidefinite(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0 || !is_symmetric(matrix)) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() >= -kSymmetric * matrix.norm();
}

Eigen::MatrixXd solve_dare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                           const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R) {
  const Eigen::Index n = A.rows();
  const Eigen::Index m = B.cols();
  if (n == 0 || m == 0 || A.cols() != n || B.rows() != n || Q.rows() != n || Q.cols() != n ||
      R.rows() != m || R.cols() != m) {
    throw std::invalid_argument("Riccati: A and Q must be n×n, B n×m and R m×m");
  }
  if (!A.allFinite() || !B.allFinite()) {
    throw std::invalid_argument("Riccati: A and B must be finite");
  }
  if (!is_positive_semidefinite(Q)) {
    throw std::invalid_argument("Riccati: Q must be symmetric positive semidefinite");
  }
  if (!is_positive_definite(R)) {
    throw std::invalid_argument("Riccati: R must be symmetric positive definite");
  }

  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd transition = A;
  Eigen::MatrixXd G = symmetric_part(B * R.llt().solve(B.transpose()));
  Eigen::MatrixXd P = Q;
  for (int k = 0; k < kMostDoublings; ++k) {
    // (I + G P) is invertible as G and P are positive semidefinite.
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(identity + G * P);
    const Eigen::MatrixXd to_transition = lu.solve(transition);  // (I + G P)⁻¹ A_k
    const Eigen::MatrixXd to_G = lu.solve(G);
    const Eigen::MatrixXd growth = symmetric_part(transition.transpose() * P * to_transition);
    G = symmetric_part(G + transition * to_G * transition.transpose());
    P += growth;
    transition = transition * to_transition;
    if (!P.allFinite()) break;
    if (growth.norm() <= kConverged * P.norm()) break;
  }

  const Eigen::MatrixXd PB = P * B;
  const Eigen::LLT<Eigen::MatrixXd> S(R + B.transpose() * PB);
  if (P.allFinite() && S.info() == Eigen::Success) {
    const Eigen::MatrixXd K = S.solve(PB.transpose() * A);
    const Eigen::MatrixXd closed = A - B * K;
    const double residual = (A.transpose() * P * closed + Q - P).norm();
    if (residual <= kSmallestResidual * P.norm() &&
        closed.eigenvalues().cwiseAbs().maxCoeff() < 1.0) {
      return P;
    }
  }
  throw std::invalid_argument("Riccati: there is no stabilising solution");
}

LqrDesign dlqr(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& R) {
  LqrDesign design;
  design.P = solve_dare(A, B, Q, R);
  const Eigen::MatrixXd PB = design.P * B;
  design.K = (R + B.transpose() * PB).llt().solve(PB.transpose() * A);
  return design;
}

}  // namespace breakwater
