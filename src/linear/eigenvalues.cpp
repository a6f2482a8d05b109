#include <breakwater/linear/eigenvalues.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <limits>

namespace breakwater {

struct EigenvalueSolver::Work {
  explicit Work(Eigen::Index n) : solver(n), values(Eigen::VectorXcd::Zero(n)) {}

  Eigen::EigenSolver<Eigen::MatrixXd> solver;
  Eigen::VectorXcd values;
};

EigenvalueSolver::EigenvalueSolver(Eigen::Index size) : work_(std::make_unique<Work>(size)) {}
EigenvalueSolver::~EigenvalueSolver() = default;

const Eigen::VectorXcd& EigenvalueSolver::solve(const Eigen::MatrixXd& A) {
  auto& [solver, values] = *work_;
  values.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (A.allFinite() && solver.compute(A, false).info() == Eigen::Success) {
    values = solver.eigenvalues();
  }
  return values;
}

std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd& A) {
  EigenvalueSolver solver(A.rows());
  const Eigen::VectorXcd& values = solver.solve(A);
  return {values.begin(), values.end()};
}

double spectral_radius(const Eigen::MatrixXd& A) {
  EigenvalueSolver solver(A.rows());
  return solver.solve(A).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

Eigen::MatrixXd left_inverse(const Eigen::MatrixXd& A) {
  return A.colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(A.rows(), A.rows()));
}

}  // namespace breakwater
