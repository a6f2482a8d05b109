#include <breakwater/linear/riccati.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <stdexcept>

#include <breakwater/linear/pole_placement.h>

namespace breakwater {
namespace {

constexpr int kMostDoublings = 60;
constexpr double kConverged = 1e-14;  // relative change of P
// Each Newton step only halves a mode on the unit circle without weight in Q. This number of steps
// is too small for such a mode. If there is a solution, the steps converge quadratically.
constexpr int kMostNewtonSteps = 30;
constexpr double kNewtonConverged = 1e-11;  // relative change of P
constexpr double kSymmetric = 1e-12;        // relative asymmetry
constexpr double kSmallestResidual = 1e-8;  // relative; above: the doubling has not converged

bool is_symmetric(const Eigen::MatrixXd& matrix) {
  return matrix.rows() == matrix.cols() && matrix.allFinite() &&
         (matrix - matrix.transpose()).norm() <= kSymmetric * matrix.norm();
}

Eigen::MatrixXd symmetric_part(const Eigen::MatrixXd& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

// K = (R + Bᵀ P B)⁻¹ Bᵀ P A
Eigen::MatrixXd feedback(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                         const Eigen::MatrixXd& R, const Eigen::MatrixXd& P) {
  const Eigen::MatrixXd PB = P * B;
  return (R + B.transpose() * PB).llt().solve(PB.transpose() * A);
}

Eigen::MatrixXd by_doubling(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                            const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R) {
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(A.rows(), A.rows());
  Eigen::MatrixXd transition = A;
  Eigen::MatrixXd G = symmetric_part(B * R.llt().solve(B.transpose()));
  Eigen::MatrixXd P = Q;
  for (int k = 0; k < kMostDoublings; ++k) {
    // (I + G P) is invertible, because G and P are positive semidefinite.
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
  return P;
}

// Newton's method from a P with stabilising feedback. Each step's P is the cost of that feedback,
//     P = (A − B K)ᵀ P (A − B K) + Q + Kᵀ R K,
// computed by doubling. Not finite if it does not converge.
Eigen::MatrixXd by_newton(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                          const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R, Eigen::MatrixXd P) {
  for (int step = 0; step < kMostNewtonSteps; ++step) {
    const Eigen::MatrixXd last = P;
    const Eigen::MatrixXd K = feedback(A, B, R, P);
    Eigen::MatrixXd closed = A - B * K;
    P = symmetric_part(Q + K.transpose() * R * K);
    for (int k = 0; k < kMostDoublings; ++k) {
      const Eigen::MatrixXd growth = symmetric_part(closed.transpose() * P * closed);
      P += growth;
      closed = closed * closed;
      if (!P.allFinite()) return P;
      if (growth.norm() <= kConverged * P.norm()) break;
    }
    if ((P - last).norm() <= kNewtonConverged * P.norm()) return P;
  }
  return Eigen::MatrixXd::Constant(A.rows(), A.rows(), std::numeric_limits<double>::quiet_NaN());
}

bool stabilises(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
                const Eigen::MatrixXd& R, const Eigen::MatrixXd& P) {
  if (!P.allFinite()) return false;
  const Eigen::MatrixXd closed = A - B * feedback(A, B, R, P);
  const double residual = (A.transpose() * P * closed + Q - P).norm();
  return residual <= kSmallestResidual * P.norm() && closed.allFinite() &&
         spectral_radius(closed) < 1.0;
}

}  // namespace

bool is_positive_definite(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0 || !is_symmetric(matrix)) return false;
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  // The pivots of a singular matrix may be rounding errors of its diagonal.
  const double rounding =
      static_cast<double>(matrix.rows()) * std::numeric_limits<double>::epsilon();
  const Eigen::ArrayXd root = factor.matrixLLT().diagonal().array();
  return (root.square() > rounding * matrix.diagonal().array()).all();
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

  Eigen::MatrixXd P = by_doubling(A, B, Q, R);
  if (stabilises(A, B, Q, R, P)) return P;
  // An unstable mode without weight in Q: the doubling finds the cheapest solution, which leaves
  // this mode unstable. With a Q that weighs all modes it stabilises, and Newton's method follows.
  const double scale = std::max(1.0, Q.norm());
  P = by_doubling(A, B, Q + scale * Eigen::MatrixXd::Identity(n, n), R);
  if (P.allFinite()) P = by_newton(A, B, Q, R, P);
  if (stabilises(A, B, Q, R, P)) return P;
  throw std::invalid_argument("Riccati: there is no stabilising solution");
}

LqrDesign dlqr(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& R) {
  LqrDesign design;
  design.P = solve_dare(A, B, Q, R);
  design.K = feedback(A, B, R, design.P);
  return design;
}

}  // namespace breakwater
