// Variance-based sensitivity indices of a Saltelli design.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include <breakwater/statistics/confidence_interval.h>

namespace breakwater {

struct SensitivityIndex {
  double value;
  std::optional<ConfidenceInterval> interval;
};

struct SensitivityIndices {
  std::vector<SensitivityIndex> first_order;  ///< S_i: what y varies less if x_i is known
  std::vector<SensitivityIndex> total;        ///< T_i: what y still varies if all but x_i are known
  Eigen::Index rows = 0;                      ///< N, rows that count
  Eigen::Index dropped_rows = 0;              ///< rows with a missing output
};

/// The indices of an output y = f(x₁ … x_d) of independent x, from its values f_A, f_AB⁽¹⁾ …
/// f_AB⁽ᵈ⁾, f_B at the rows of the design that make_sampler() calls saltelli: `f` is N × (d + 2).
///     S_i = 1/N Σ_j (f_B − μ)(f_AB⁽ⁱ⁾ − f_A) / V
///     T_i = 1/(2N) Σ_j (f_A − f_AB⁽ⁱ⁾)² / V
/// with the mean μ and the variance V of all f_A and f_B. S_i is y's share of variance that x_i
/// makes alone, T_i with its interactions: 0 ≤ S_i ≤ T_i, Σ S_i ≤ 1, but for errors of sampling,
/// which may make a small S_i negative.
///
/// A row with an output that is missing (NaN, infinite) is dropped whole: the rest says how y
/// depends on x where all d + 2 runs have it. What depends on x is also whether y is missing: for
/// that f is 1 where a run failed and 0 elsewhere.
///
/// There are no indices (empty) where fewer than two rows are left or f_A and f_B do not vary but
/// for rounding: of nothing there are no shares.
///
/// The intervals are the bootstrap's percentiles: rows are drawn again, with replacement. Rows of
/// Sobol' points are spread more evenly than such draws, so the intervals are rather too wide than
/// too narrow. Replicates without variance are left out; if they are more than one in twenty (a
/// failure or two in all), there is no interval.
///
/// Sources: A. Saltelli et al., Comput. Phys. Commun. 181 (2010) 259–270, table 2 (b) and (f), the
/// latter by M. J. W. Jansen, Comput. Phys. Commun. 117 (1999) 35–43; G. Archer, A. Saltelli, I. M.
/// Sobol', J. Statist. Comput. Simul. 58 (1997) 99–120 (the bootstrap).
///
/// Throws std::invalid_argument if f has fewer than three columns, replicates < 0 (0: no intervals)
/// or the level is not in (0, 1).
SensitivityIndices sensitivity_indices(const Eigen::MatrixXd& f,
                                       const BootstrapSettings& bootstrap = {});

}  // namespace breakwater
