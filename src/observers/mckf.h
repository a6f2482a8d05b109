// Maximum-correntropy Kalman filter as a disturbance observer (MKCKF-DOB).
#pragma once

#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/guarded_kalman.h>

namespace breakwater {

struct CorrentropyDesign {
  double kernel_width = 3.0;  ///< σ > 0, in standard deviations of the predicted disturbance
  Likelihood likelihood = Likelihood::gauss;
};

/// A Kalman filter whose predicted disturbance loses its weight if the measurement moves d̂ far
/// from it. Five fixed-point iterations start from d̂ = d̂(k|k−1), with P = P(k|k−1) and its column
/// p_d of the highest derivative of d:
///     c = max(10⁻⁴, exp(−(d̂ − d̂(k|k−1))²/(2 σ² P_dd))),   P′ = P + (1/c − 1) p_d p_dᵀ/P_dd,
///     K = P′ C̅ᵀ/(C̅ P′ C̅ᵀ + R),   x̄ = x̄(k|k−1) + K ê.
/// The covariance is (I − K C̅) P (I − K C̅)ᵀ + K R Kᵀ. This is the paper's filter with kernels of
/// infinite width for x and y, and d first in its Cholesky factor. For σ → ∞ it is the Kalman
/// filter. λ(k) is c.
///
/// Sources: S. Li et al., arXiv 2410.05061 (immkf.h); B. Chen, X. Liu, H. Zhao, J. C. Príncipe,
/// Automatica 76 (2017) 70–77.
///
/// Throws std::invalid_argument unless σ is positive.
std::unique_ptr<KalmanEstimator> sized_mckf(const KalmanDesign& design, const SensorError& sensor,
                                            const CorrentropyDesign& correntropy);

}  // namespace breakwater
