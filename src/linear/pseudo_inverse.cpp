#include <breakwater/linear/pseudo_inverse.h>

#include <Eigen/Eigenvalues>

namespace breakwater {
namespace {

// `below` replaces 1/σ² if σ does not exceed the tolerance.
void invert(const Eigen::Matrix<double, 3, Eigen::Dynamic>& J, double tolerance, double below,
            Eigen::Matrix<double, Eigen::Dynamic, 3>& J_plus) {
  // J = U Σ Vᵀ gives J Jᵀ = U Σ² Uᵀ and J⁺ = Jᵀ U Σ⁻² Uᵀ.
  const Eigen::Matrix3d squared = J.lazyProduct(J.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(squared);
  const double smallest = tolerance * tolerance;
  const Eigen::Vector3d inverse =
      (eigen.eigenvalues().array() > smallest).select(eigen.eigenvalues().cwiseInverse(), below);
  const Eigen::Matrix3d weight =
      eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  J_plus.noalias() = J.transpose() * weight;
}

}  // namespace

void pseudo_inverse(const Eigen::Matrix<double, 3, Eigen::Dynamic>& J, double tolerance,
                    Eigen::Matrix<double, Eigen::Dynamic, 3>& J_plus) {
  invert(J, tolerance, 0.0, J_plus);
}

void damped_pseudo_inverse(const Eigen::Matrix<double, 3, Eigen::Dynamic>& J, double tolerance,
                           Eigen::Matrix<double, Eigen::Dynamic, 3>& J_plus) {
  invert(J, tolerance, 1.0 / (tolerance * tolerance), J_plus);
}

}  // namespace breakwater
