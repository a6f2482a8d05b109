// Moore–Penrose inverse of a task Jacobian.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// J⁺ (n×3) of J (3×n). Singular values up to `tolerance` (absolute, in J's unit) count as zero. It
/// uses the eigenvectors of J Jᵀ, so a tolerance below 1e-7·‖J‖ has no effect. `J_plus` must have
/// its size; allocates nothing.
void pseudo_inverse(const Eigen::Matrix<double, 3, Eigen::Dynamic>& J, double tolerance,
                    Eigen::Matrix<double, Eigen::Dynamic, 3>& J_plus);

/// The same, but a singular value σ up to the tolerance gives σ/tolerance² instead of 1/σ: this is
/// continuous, and 0 at σ = 0.
void damped_pseudo_inverse(const Eigen::Matrix<double, 3, Eigen::Dynamic>& J, double tolerance,
                           Eigen::Matrix<double, Eigen::Dynamic, 3>& J_plus);

}  // namespace breakwater
