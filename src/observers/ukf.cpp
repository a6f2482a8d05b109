#include <breakwater/observers/ukf.h>

#include <Eigen/Eigenvalues>

namespace breakwater {

void raise_eigenvalues(Eigen::Ref<Eigen::MatrixXd> matrix, double floor) {
  // One type for every n: each further type adds seconds to the compilation.
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostStates, kMostStates>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostStates, 1>;
  const Eigen::SelfAdjointEigenSolver<Matrix> solver{Matrix(matrix)};
  const Vector values =
      solver.eigenvalues().cwiseMax(floor * solver.eigenvalues().maxCoeff()).eval();
  matrix.noalias() =
      solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace breakwater
