#include <breakwater/linear/eigenvalues.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace Eigen::internal {

// Never called: Eigen reflects in blocks from two columns on, and a vector has one. The empty body
// saves the compilation of the blocks.
template <>
inline void apply_block_householder_on_the_left(Block<VectorXd, Dynamic, Dynamic>&,
                                                const Block<MatrixXd, Dynamic, Dynamic>&,
                                                const VectorBlock<const VectorXd>&, bool) {}

}  // namespace Eigen::internal

namespace breakwater {

// The steps of Eigen::EigenSolver, which takes twice as long to compile for its vectors.
struct EigenvalueSolver::Work {
  explicit Work(Eigen::Index n)
      : hessenberg(n),
        schur(n),
        T(Eigen::MatrixXd::Zero(n, n)),
        values(Eigen::VectorXcd::Zero(n)) {}

  Eigen::HessenbergDecomposition<Eigen::MatrixXd> hessenberg;
  Eigen::RealSchur<Eigen::MatrixXd> schur;
  Eigen::MatrixXd T;
  Eigen::VectorXcd values;
};

EigenvalueSolver::EigenvalueSolver(Eigen::Index size) : work_(std::make_unique<Work>(size)) {}
EigenvalueSolver::~EigenvalueSolver() = default;

const Eigen::VectorXcd& EigenvalueSolver::solve(const Eigen::MatrixXd& A) {
  auto& [hessenberg, schur, T, values] = *work_;
  const Eigen::Index n = A.rows();
  const double scale = A.cwiseAbs().maxCoeff();
  values.setConstant(scale);
  if (!(scale > 0.0)) return values;
  T = A / scale;
  hessenberg.compute(T);
  T = hessenberg.packedMatrix();
  for (Eigen::Index j = 0; j + 2 < n; ++j) T.col(j).tail(n - j - 2).setZero();
  schur.computeFromHessenberg(T, T, false);
  T = schur.matrixT() * scale;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i + 1 == n || T(i + 1, i) == 0.0) {
      values(i) = T(i, i);
      continue;
    }
    // A block with a complex pair.
    const double half = 0.5 * (T(i, i) - T(i + 1, i + 1));
    const double largest = std::max({std::abs(half), std::abs(T(i + 1, i)), std::abs(T(i, i + 1))});
    const double square =
        half / largest * (half / largest) + T(i + 1, i) / largest * (T(i, i + 1) / largest);
    const double imaginary = largest * std::sqrt(std::abs(square));
    values(i) = {T(i + 1, i + 1) + half, imaginary};
    values(i + 1) = std::conj(values(i));
    ++i;
  }
  return values;
}

std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd& A) {
  EigenvalueSolver solver(A.rows());
  const Eigen::VectorXcd& values = solver.solve(A);
  return {values.begin(), values.end()};
}

double spectral_radius(const Eigen::MatrixXd& A) {
  double largest = 0.0;
  for (const std::complex<double>& value : eigenvalues(A)) {
    largest = std::max(largest, std::abs(value));
  }
  return largest;
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

// ColPivHouseholderQR::solve() gives the same, and takes longer to compile.
Eigen::MatrixXd left_inverse(const Eigen::MatrixXd& A) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  const Eigen::Index n = A.rows(), rank = qr.nonzeroPivots();
  Eigen::MatrixXd QR = qr.matrixQR(), reflected = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd workspace(n);
  for (Eigen::Index k = 0; k < rank; ++k) {
    reflected.bottomRightCorner(n - k, n).applyHouseholderOnTheLeft(
        QR.col(k).tail(n - k - 1), qr.hCoeffs()(k), workspace.data());
  }
  auto solved = reflected.topRows(rank);
  QR.topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solveInPlace(solved);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(A.cols(), n);
  for (Eigen::Index k = 0; k < rank; ++k) {
    inverse.row(qr.colsPermutation().indices()(k)) = solved.row(k);
  }
  return inverse;
}

}  // namespace breakwater
