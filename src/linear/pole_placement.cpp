#include <breakwater/linear/pole_placement.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

// A design is done once, and the poles of a fast sampled observer crowd together just below 1,
// which makes the eigenvector matrix badly conditioned: extended precision costs nothing here.
using Scalar = std::complex<long double>;
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

constexpr long double kSmallestRcond = 1e-16L;

void check_group(const PoleGroup& group) {
  for (const auto& pole : group) {
    if (!std::isfinite(pole.real()) || !std::isfinite(pole.imag())) {
      throw std::invalid_argument("pole placement: a pole is not finite");
    }
    if (std::count(group.begin(), group.end(), pole) !=
        std::count(group.begin(), group.end(), std::conj(pole))) {
      throw std::invalid_argument("pole placement: a complex pole lacks its conjugate");
    }
  }
}

// Equal poles side by side, so that the second of them finds its Jordan chain just before it.
PoleGroup sorted(PoleGroup group) {
  std::sort(group.begin(), group.end(), [](const auto& a, const auto& b) {
    return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag());
  });
  return group;
}

}  // namespace

Eigen::MatrixXd place_observer_poles(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                     const std::vector<PoleGroup>& groups) {
  const Eigen::Index n = A.rows();
  const Eigen::Index p = C.rows();
  std::size_t count = 0;
  for (const auto& group : groups) count += group.size();
  if (A.cols() != n || C.cols() != n || static_cast<Eigen::Index>(groups.size()) != p ||
      static_cast<Eigen::Index>(count) != n) {
    throw std::invalid_argument("pole placement: needs one group of poles per output, " +
                                std::to_string(n) + " poles in all");
  }

  Matrix W(n, n);
  Matrix V = Matrix::Zero(p, n);
  Eigen::Index column = 0;
  for (Eigen::Index output = 0; output < p; ++output) {
    check_group(groups[output]);
    const PoleGroup group = sorted(groups[output]);
    for (std::size_t i = 0; i < group.size(); ++i, ++column) {
      const bool repeated = i > 0 && group[i] == group[i - 1];
      const Matrix shifted =
          A.transpose().cast<Scalar>() - Scalar(group[i]) * Matrix::Identity(n, n);
      const Eigen::FullPivLU<Matrix> lu(shifted);
      if (!lu.isInvertible()) {
        throw std::invalid_argument("pole placement: a pole already is an eigenvalue of the plant");
      }
      if (repeated) {
        W.col(column) = lu.solve(Vector(W.col(column - 1)));
      } else {
        V(output, column) = 1.0L;
        W.col(column) = lu.solve(Vector(C.row(output).transpose().cast<Scalar>()));
      }
    }
  }

  // Wᵀ H = Vᵀ, solved on balanced rows and columns: states differ in scale by powers of T_s.
  const Eigen::Array<long double, Eigen::Dynamic, 1> row_scale =
      W.rowwise().norm().array().max(1e-300L);
  const Matrix rows_scaled = row_scale.inverse().matrix().cast<Scalar>().asDiagonal() * W;
  const Eigen::Array<long double, Eigen::Dynamic, 1> column_scale =
      rows_scaled.colwise().norm().transpose().array();
  const Matrix balanced = rows_scaled * column_scale.inverse().matrix().cast<Scalar>().asDiagonal();
  const Eigen::FullPivLU<Matrix> lu(balanced.transpose());
  if (!lu.isInvertible() || !(lu.rcond() > kSmallestRcond)) {
    throw std::invalid_argument(
        "pole placement: the poles cannot be placed so (not observable, or poles too close)");
  }
  const Matrix scaled_V =
      column_scale.inverse().matrix().cast<Scalar>().asDiagonal() * V.transpose();
  const Matrix H = row_scale.inverse().matrix().cast<Scalar>().asDiagonal() * lu.solve(scaled_V);
  return H.real().cast<double>();
}

std::vector<PoleGroup> sample_poles(const std::vector<PoleGroup>& continuous, double period_s) {
  std::vector<PoleGroup> sampled = continuous;
  for (auto& group : sampled) {
    for (auto& pole : group) {
      if (!(pole.real() < 0.0)) {
        throw std::invalid_argument(
            "pole placement: the poles must lie left of the imaginary axis");
      }
      pole = math::exp(pole * period_s);
    }
  }
  return sampled;
}

PoleGroup eigenvalues(const Eigen::MatrixXd& A) {
  const Eigen::VectorXcd values = A.eigenvalues();
  return {values.begin(), values.end()};
}

double spectral_radius(const Eigen::MatrixXd& A) {
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace breakwater
