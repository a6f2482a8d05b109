// Eigenvalues of real matrices, and least squares: each decomposition is compiled once, here.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <vector>

namespace breakwater {

/// The eigenvalues of real square matrices of one size, in the order of Eigen::EigenSolver.
/// Allocates nothing after construction.
class EigenvalueSolver {
 public:
  explicit EigenvalueSolver(Eigen::Index size);
  ~EigenvalueSolver();
  EigenvalueSolver(const EigenvalueSolver&) = delete;
  EigenvalueSolver& operator=(const EigenvalueSolver&) = delete;

  /// The eigenvalues of `A` (n×n). They are NaN unless it is finite.
  const Eigen::VectorXcd& solve(const Eigen::MatrixXd& A);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// The eigenvalues of a real square matrix.
std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd& A);

/// The largest magnitude of an eigenvalue; NaN unless A is finite.
double spectral_radius(const Eigen::MatrixXd& A);

/// The smallest x that minimises ‖A x − b‖, by a complete orthogonal decomposition of A.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// The inverse of A, or its left inverse (AᵀA)⁻¹Aᵀ if it has fewer columns than rows.
Eigen::MatrixXd left_inverse(const Eigen::MatrixXd& A);

}  // namespace breakwater
