// Variational-Bayes adaptive Kalman filter (VBAKF).
#pragma once

#include <breakwater/observers/guarded_kalman.h>

namespace breakwater {

struct VariationalDesign {
  double forgetting = 0.98;    ///< ρ in (0, 1]; 1: R is known
  double prior_samples = 3.0;  ///< τ > 0: weight of the predicted covariance, in samples
  int iterations = 10;         ///< fixed-point iterations in a sample, ≥ 1
};

/// A Kalman filter that estimates its own P(k|k−1) and R. Their priors are inverse Wishart
/// distributions. P̃ is the nominal prediction A̅ P A̅ᵀ + Q, and T/ν the estimate of R. One sample has
/// ν⁻ = ρ ν, T⁻ = ρ T, and from x̄⁰ = x̄(k|k−1), P⁰ = P̃ the iterations
///     P(k|k−1) = (τ P̃ + Pⁱ + (x̄ⁱ − x̄(k|k−1))(x̄ⁱ − x̄(k|k−1))ᵀ)/(τ + 1),
///     R = (T⁻ + (y − C̅ x̄ⁱ)² + C̅ Pⁱ C̅ᵀ)/(ν⁻ + 1),
/// each followed by the Kalman correction with them. ν starts at its limit 1/(1 − ρ). τ → ∞ is the
/// filter of Särkkä and Nummenmaa, which estimates R alone. With ρ = 1 too, it is the Kalman
/// filter.
///
/// Sources: Y. Huang, Y. Zhang, Z. Wu, N. Li, J. Chambers, IEEE Trans. Autom. Control 63 (2018)
/// 594–601; S. Särkkä, A. Nummenmaa, IEEE Trans. Autom. Control 54 (2009) 596–600.
///
/// Throws std::invalid_argument if a number is out of its range.
std::unique_ptr<KalmanEstimator> sized_vbakf(const KalmanDesign& design,
                                             const VariationalDesign& variational);

}  // namespace breakwater
