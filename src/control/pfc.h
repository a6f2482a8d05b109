// Predictive functional control (PFC) of one joint: thesis 2.4.2.5 to 2.4.2.8.
#pragma once

#include <vector>

namespace breakwater {

/// Design parameters of a predictive functional controller (PFC).
struct PfcDesign {
  double target_response_time_s = 1.0;  ///< T_ref: the reference's error falls to 5 %
  double period_s = 1e-3;               ///< T_s
  int coincidence_points = 3;           ///< n
  int basis_functions = 3;              ///< 1: step; 2: and ramp; 3: and parabola; at most n
};

/// PFC of a double integrator q̈ = u. Sampled: x_q(k+1) = A_q x_q(k) + B_q u(k), y = C_q x_q
/// with A_q = [1 T_s; 0 1], B_q = [0; T_s], C_q = [1 0] (Eqs. 2.69–2.73). The reference
/// trajectory is T(k+i) = s − αⁱ (s − y), α = e^{−3 T_s/T_ref} (Eqs. 2.74, 2.75). The coincidence
/// points are h_j = ⌊T_ref/(T_s (n − j + 1))⌋ (Eq. 2.76).
///
/// The input combines step, ramp and parabola, u(i) = Σ_l μ_l (i T_s)^l. Their responses are
/// stacked, not summed (Eq. 2.79). The h×b system
///     y_b(h_j)ᵀ μ = (1 − α^{h_j}) (s − y) − C_q (A_q^{h_j} − I) x_q
/// is solved directly, by least squares if there are more points than bases. This gives the
/// smallest V of Eqs. 2.77 and 2.78, like Eq. 2.80. Only μ_1 acts: without constraints the
/// controller is u = k_p (s − q) − k_d q̇ (Eqs. 2.85, 2.86).
class Pfc {
 public:
  Pfc() : Pfc(PfcDesign()) {}
  /// Throws std::invalid_argument unless T_ref and T_s are positive and finite, 1 ≤ bases ≤ 3 and
  /// bases ≤ n. Each coincidence point must be at least one sample after the last one, and the
  /// first at least 2.
  explicit Pfc(const PfcDesign& design);

  /// The unconstrained acceleration reference μ_1 [rad/s²].
  double acceleration(double setpoint_rad, double q_rad, double dq_rad_s) const {
    return k_p_ * (setpoint_rad - q_rad) - k_d_ * dq_rad_s;
  }

  double k_p() const { return k_p_; }                                     ///< [1/s²]
  double k_d() const { return k_d_; }                                     ///< [1/s]
  double alpha() const { return alpha_; }                                 ///< Eq. 2.75
  const std::vector<int>& coincidence_points() const { return points_; }  ///< h_j [samples]

 private:
  double alpha_ = 0.0;
  std::vector<int> points_;
  double k_p_ = 0.0;
  double k_d_ = 0.0;
};

}  // namespace breakwater
