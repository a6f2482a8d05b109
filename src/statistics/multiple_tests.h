// Tests of several hypotheses or several candidates together.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace breakwater {

/// Holm's adjusted p: with p₍₁₎ ≤ … ≤ p₍ₘ₎,  p'₍ᵢ₎ = max_{j ≤ i} min(1, (m − j + 1) p₍ⱼ₎). A
/// rejection where p' ≤ α gives any false rejection with probability α at most, for any dependence.
///
/// Source: S. Holm, Scand. J. Statist. 6 (1979) 65–70.
std::vector<double> holm(const std::vector<double>& p);

/// Friedman's average ranks: the ranks of the values in each row (block), averaged over the rows
/// for each column (candidate). The smallest value has rank 1. Equal values share their ranks.
/// There must be a row.
///
/// Source: M. Friedman, J. Amer. Statist. Assoc. 32 (1937) 675–701.
Eigen::VectorXd average_ranks(const Eigen::MatrixXd& values);

/// Nemenyi's critical difference of average ranks of k ≥ 2 candidates over n blocks:
///     CD = q_α/√2 · √(k (k + 1)/(6 n))
/// with the upper α quantile q_α of the studentized range for k and infinitely many degrees of
/// freedom. Candidates differ if their ranks differ by more. The probability of any false result is
/// α at most.
///
/// Sources: P. Nemenyi, Distribution-free multiple comparisons, Princeton 1963; J. Demšar, J. Mach.
/// Learn. Res. 7 (2006) 1–30.
double critical_difference(std::size_t candidates, std::size_t worlds, double alpha);

/// The q with P(Q > q) = alpha, where Q is the range of k independent standard normal variables:
///     P(Q ≤ q) = k ∫ φ(z) (Φ(z) − Φ(z − q))ᵏ⁻¹ dz
/// Error below 1e-9; k ≥ 2, 0 < alpha < 1.
double normal_range_quantile(std::size_t k, double alpha);

}  // namespace breakwater
