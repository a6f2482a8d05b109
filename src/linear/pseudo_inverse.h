// Moore–Penrose inverse of a task Jacobian.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// J⁺ (n×3) of J (3×n), in which singular values at or below `tolerance` (absolute, in J's unit)
/// count as zero. By the eigenvectors of J Jᵀ, so a tolerance below 1e-7·‖J‖ means nothing.
/// `J_plus` must have its size; allocates nothing.
void pseudo_inverse(const Eigen::Matrix<double, 3, Eigen::Dynamic>& J, double tolerance,
                    Eigen::Matrix<double, Eigen::Dynamic, 3>& J_plus);

/// The same, where a singular value σ at or below the tolerance counts as σ/tolerance² instead of
/// 1/σ: continuous there, and 0 at 0.
void damped_pseudo_inverse(const Eigen::Matrix<double, 3, Eigen::Dynamic>& J, double tolerance,
                           Eigen::Matrix<double, Eigen::Dynamic, 3>& J_plus);

}  // namespace breakwater
