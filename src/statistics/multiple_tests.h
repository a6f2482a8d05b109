// Several hypotheses, or several candidates, at once.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace breakwater {

/// Holm's adjusted p: with p₍₁₎ ≤ … ≤ p₍ₘ₎,  p'₍ᵢ₎ = max_{j ≤ i} min(1, (m − j + 1) p₍ⱼ₎). To
/// reject where p' ≤ α makes one false rejection or more with probability α at most, whatever
/// depends on what.
///
/// Source: S. Holm, Scand. J. Statist. 6 (1979) 65–70.
std::vector<double> holm(const std::vector<double>& p);

/// Friedman's average ranks: of each row's values, 1 for the smallest, equal ones sharing theirs,
/// the mean over the rows (worlds) for each column (candidate). At least one row.
///
/// Source: M. Friedman, J. Amer. Statist. Assoc. 32 (1937) 675–701.
Eigen::VectorXd average_ranks(const Eigen::MatrixXd& values);

/// Nemenyi's critical difference of average ranks of k ≥ 2 candidates over n worlds:
///     CD = q_α/√2 · √(k (k + 1)/(6 n))
/// with the upper α quantile q_α of the studentized range of k and infinitely many degrees of
/// freedom. Two whose ranks differ by more do differ, all pairs together wrong with probability α
/// at most.
///
/// Sources: P. Nemenyi, Distribution-free multiple comparisons, Princeton 1963; J. Demšar, J. Mach.
/// Learn. Res. 7 (2006) 1–30.
double critical_difference(std::size_t candidates, std::size_t worlds, double alpha);

/// q with P(Q > q) = alpha of the range Q of k independent standard normal variables:
///     P(Q ≤ q) = k ∫ φ(z) (Φ(z) − Φ(z − q))ᵏ⁻¹ dz
/// to 1e-9; k ≥ 2, 0 < alpha < 1.
double normal_range_quantile(std::size_t k, double alpha);

}  // namespace breakwater
