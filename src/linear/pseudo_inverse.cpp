#include <breakwater/linear/pseudo_inverse.h>

#include <Eigen/Eigenvalues>

namespace breakwater {
namespace {

using Jacobian = Eigen::Ref<const Eigen::MatrixXd>;
using Inverse = Eigen::Ref<Eigen::MatrixXd>;

// `below` replaces 1/σ² if σ does not exceed the tolerance.
void invert(const Jacobian& J, double tolerance, double below, Inverse J_plus) {
  with_size(J.rows(), [&](auto c) {
    constexpr int kMost = c == Eigen::Dynamic ? 6 : c;
    using Square = Eigen::Matrix<double, c, c, 0, kMost, kMost>;
    using Vector = Eigen::Matrix<double, c, 1, 0, kMost, 1>;
    const Eigen::Map<const Eigen::Matrix<double, c, Eigen::Dynamic, 0, kMost, Eigen::Dynamic>> own(
        J.data(), J.rows(), J.cols());
    // J = U Σ Vᵀ gives J Jᵀ = U Σ² Uᵀ and J⁺ = Jᵀ U Σ⁻² Uᵀ.
    const Square squared = own.lazyProduct(own.transpose());
    const Eigen::SelfAdjointEigenSolver<Square> eigen(squared);
    const double smallest = tolerance * tolerance;
    const Vector inverse =
        (eigen.eigenvalues().array() > smallest).select(eigen.eigenvalues().cwiseInverse(), below);
    const Square weight =
        eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, c, 0, Eigen::Dynamic, kMost>>(
        J_plus.data(), J_plus.rows(), J_plus.cols())
        .noalias() = own.transpose() * weight;
  });
}

}  // namespace

// NOLINTBEGIN(performance-unnecessary-value-param): a view
void pseudo_inverse(const Jacobian& J, double tolerance, Inverse J_plus) {
  invert(J, tolerance, 0.0, J_plus);
}

void damped_pseudo_inverse(const Jacobian& J, double tolerance, Inverse J_plus) {
  invert(J, tolerance, 1.0 / (tolerance * tolerance), J_plus);
}
// NOLINTEND(performance-unnecessary-value-param)

Eigen::VectorXd singular_values(const Jacobian& J) {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  const Eigen::SelfAdjointEigenSolver<Square> eigen(Square(J.lazyProduct(J.transpose())),
                                                    Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt();
}

void multiply(const Eigen::MatrixXd& J_plus, const Eigen::Ref<const Eigen::VectorXd>& x,
              Eigen::Ref<Eigen::VectorXd> out) {
  with_size(x.size(), [&](auto c) {
    constexpr int kMost = c == Eigen::Dynamic ? 6 : c;
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, c, 0, Eigen::Dynamic, kMost>> own(
        J_plus.data(), J_plus.rows(), J_plus.cols());
    const Eigen::Matrix<double, c, 1, 0, kMost, 1> factor = x;
    out.noalias() = own * factor;
  });
}

}  // namespace breakwater
