// Moore–Penrose inverse and singular values of a task Jacobian.
#pragma once

#include <Eigen/Core>
#include <type_traits>

namespace breakwater {

/// J⁺ (n×c) of J (c×n), c ≤ 6. Singular values up to `tolerance` (absolute, in J's unit) count as
/// zero. It uses the eigenvectors of J Jᵀ, so a tolerance below 1e-7·‖J‖ has no effect. Both
/// matrices are contiguous and have their size. Allocates nothing.
void pseudo_inverse(const Eigen::Ref<const Eigen::MatrixXd>& J, double tolerance,
                    Eigen::Ref<Eigen::MatrixXd> J_plus);

/// The same, but a singular value σ up to the tolerance gives σ/tolerance² instead of 1/σ: this is
/// continuous, and 0 at σ = 0.
void damped_pseudo_inverse(const Eigen::Ref<const Eigen::MatrixXd>& J, double tolerance,
                           Eigen::Ref<Eigen::MatrixXd> J_plus);

/// The singular values of J (c×n, c ≤ 6), the largest first: c of them, exact to 1e-7·‖J‖.
Eigen::VectorXd singular_values(const Eigen::Ref<const Eigen::MatrixXd>& J);

/// Calls `compute` with the number c as a constant: 3, with its order of additions, or
/// Eigen::Dynamic for all other numbers.
template <typename Compute>
void with_size(Eigen::Index c, Compute&& compute) {
  if (c == 3) {
    compute(std::integral_constant<int, 3>());
  } else {
    compute(std::integral_constant<int, Eigen::Dynamic>());
  }
}

/// out = J⁺ x. Allocates nothing.
void multiply(const Eigen::MatrixXd& J_plus, const Eigen::Ref<const Eigen::VectorXd>& x,
              Eigen::Ref<Eigen::VectorXd> out);

}  // namespace breakwater
