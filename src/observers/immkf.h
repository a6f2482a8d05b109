// Interacting-multiple-model Kalman filter as a disturbance observer (IMMKF-DOB).
#pragma once

#include <array>

#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/guarded_kalman.h>

namespace breakwater {

struct ImmDesign {
  double noise_ratio = 1e4;    ///< η > 0: noise of d in the busy model over that of the quiet one
  double stays_quiet = 0.999;  ///< probability that the quiet model is followed by itself
  double stays_busy = 0.5;     ///< the same for the busy model
  Likelihood likelihood = Likelihood::gauss;
};

/// Two Kalman filters of one plant. The disturbance changes little (Q) or much (η Q on its highest
/// derivative), with a Markov chain between both. One sample, with T_ij = P(j after i):
///     c_j = Σ_i T_ij μ_i,   μ_{i|j} = T_ij μ_i/c_j,
///     x̄_j0 = Σ_i μ_{i|j} x̄_i,   P_j0 = Σ_i μ_{i|j} (P_i + (x̄_i − x̄_j0)(x̄_i − x̄_j0)ᵀ),
/// then each filter predicts and corrects from (x̄_j0, P_j0), and with its likelihood L_j
///     μ_j = L_j c_j/Σ L_i c_i,   x̂ = Σ μ_j x̄_j.
///
/// Sources: S. Li, D. Shi, X. Lyu, J. Tang, L. Shi, "Bias–variance trade-off in Kalman filter-based
/// disturbance observers", arXiv 2410.05061; H. A. P. Blom, Y. Bar-Shalom, IEEE Trans. Autom.
/// Control 33 (1988) 780–783.
///
/// Throws std::invalid_argument if a probability is outside of [0, 1] or η is not positive.
std::unique_ptr<KalmanEstimator> sized_immkf(const KalmanDesign& design, const SensorError& sensor,
                                             const ImmDesign& imm);

}  // namespace breakwater
