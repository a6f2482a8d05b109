#include <breakwater/linear/observability.h>

#include <Eigen/QR>

namespace breakwater {
namespace {

Eigen::MatrixXd observability_matrix(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C) {
  const Eigen::Index n = A.rows();
  const Eigen::Index p = C.rows();
  Eigen::MatrixXd U_o(p * n, n);
  Eigen::MatrixXd block = C;
  for (Eigen::Index i = 0; i < n; ++i) {
    U_o.middleRows(i * p, p) = block;
    block = block * A;
  }
  return U_o;
}

}  // namespace

Eigen::Index observability_rank(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C) {
  Eigen::MatrixXd U_o = observability_matrix(A, C);
  for (auto column : U_o.colwise()) {
    const double norm = column.norm();
    if (norm > 0.0) column /= norm;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(U_o);
  qr.setThreshold(1e-12);
  return qr.rank();
}

double smallest_pivot(const Eigen::MatrixXd& matrix) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  const auto pivots = qr.matrixQR().diagonal().cwiseAbs();
  return qr.maxPivot() > 0.0 ? pivots(pivots.size() - 1) / qr.maxPivot() : 0.0;
}

}  // namespace breakwater
