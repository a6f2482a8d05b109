// Gaussian-sum filter for an encoder code, with the disturbance as an unknown input (GSF).
#pragma once

#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/guarded_kalman.h>

namespace breakwater {

/// Kalman filters whose weighted densities form that of x̄ = [x; d]. The probability of a code is
/// ∫ N(z; C̅ x̄, s²) dz over the code's interval of length ℓ. A quadrature replaces it, with the five
/// nodes ζ_j of Gauss and Legendre and their weights ω_j:
///     p(y | x̄) ≈ ℓ Σ ω_j N(ζ_j; C̅ x̄, s² + (ω_j ℓ)²/12),   Σ ω_j = 1.
/// Each part i of the sum thus becomes five, corrected by a measurement ζ_j, with the weight
/// w_i ω_j N(ζ_j; C̅ x̄_i, ·). The second term of the variance is that of a uniform density on the
/// node's share of the interval. It is not in the paper, whose sensor has noise before rounding.
/// Pairs of parts whose union changes the density least are then joined, down to `parts`. K(k) is
/// the weighted mean of the parts' gains.
///
/// Sources: R. A. González, A. L. Cedeño, arXiv 2504.09711 (the sum for a code, and the unknown
/// input); A. R. Runnalls, IEEE Trans. Aerosp. Electron. Syst. 43 (2007) 989–999 (the reduction).
///
/// Throws std::invalid_argument unless `parts` is from 1 to 20.
std::unique_ptr<KalmanEstimator> sized_gsf(const KalmanDesign& design, const SensorError& sensor,
                                           int parts);

}  // namespace breakwater
