// Variance-based sensitivity indices from a Saltelli design.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/statistics/distribution.h>

namespace breakwater {

struct SensitivityIndices {
  std::vector<EstimatedValue> first_order;  ///< S_i: share of the variance that x_i explains alone
  std::vector<EstimatedValue> total;        ///< T_i: share that remains if all but x_i are known
  Eigen::Index rows = 0;                    ///< N, used rows
  Eigen::Index dropped_rows = 0;            ///< rows with a missing output
};

/// The indices of an output y = f(x₁ … x_d) of independent x. `f` is N × (d + 2): the outputs f_A,
/// f_AB⁽¹⁾ … f_AB⁽ᵈ⁾, f_B in the rows of the design `saltelli` of make_sampler().
///     S_i = 1/N Σ_j (f_B − μ)(f_AB⁽ⁱ⁾ − f_A) / V
///     T_i = 1/(2N) Σ_j (f_A − f_AB⁽ⁱ⁾)² / V
/// with the mean μ and the variance V of all f_A and f_B. S_i is the share of the variance of y
/// from x_i alone, T_i includes interactions: 0 ≤ S_i ≤ T_i and Σ S_i ≤ 1. Sampling errors may make
/// a small S_i negative.
///
/// A row with a missing output (NaN, infinite) is dropped, so the indices describe only x where all
/// d + 2 runs have a value. To study where y is missing, use f = 1 for a failed run and 0
/// otherwise. The indices are empty if fewer than two rows are left or f_A and f_B differ only by
/// rounding.
///
/// The 95 % intervals are percentiles of a bootstrap with so many replicates, which resample the
/// rows with replacement. Rows of Sobol' points are spread more evenly than such draws, so the
/// intervals are rather too wide than too narrow. Replicates without variance are left out. There
/// is no interval if they are more than one in twenty, as with only one or two failures.
///
/// Sources: A. Saltelli et al., Comput. Phys. Commun. 181 (2010) 259–270, table 2 (b) and (f), the
/// latter by M. J. W. Jansen, Comput. Phys. Commun. 117 (1999) 35–43; G. Archer, A. Saltelli, I. M.
/// Sobol', J. Statist. Comput. Simul. 58 (1997) 99–120 (the bootstrap).
SensitivityIndices sensitivity_indices(const Eigen::MatrixXd& f, int replicates);

}  // namespace breakwater
