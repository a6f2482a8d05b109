// Estimates stiffness and damping of a contact from a force behind a low-pass.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// Estimates K and B of F = K δ + B δ̇ from F_f, the force behind a first-order lag τ. The same lag
/// filters δ and δ̇, so F_f = K δ_f + B v_f holds exactly. A least-squares fit uses the priors K =
/// 1000 ± 3000 N/m and B = 0 ± 30 N s/m and a noise of 0.05 N. Only samples from 4 ms to 350 ms
/// after the start of the contact count. K stays within [200, 2e5] N/m.
class ContactStiffness {
 public:
  /// Throws std::invalid_argument unless lag ≥ 0 and period > 0.
  ContactStiffness(double lag_s, double period_s);

  /// Starts a new contact.
  void reset();

  /// One sample: depth δ [m], its rate [m/s] and F_f [N]. Allocates nothing.
  void update(double depth_m, double rate_m_s, double force_N);

  double stiffness_N_m() const { return stiffness_; }
  double damping_Ns_m() const { return damping_; }
  /// The present force without the lag: F̂ = K̂ δ + (F_f − K̂ δ_f).
  double force_N() const { return force_; }

 private:
  double period_s_;
  double forget_;  // memory of the lag in one sample: e^{−T_s/τ}
  double contact_s_ = 0.0;
  double depth_f_ = 0.0;
  double rate_f_ = 0.0;
  Eigen::Matrix2d information_;
  Eigen::Vector2d vector_;
  double stiffness_ = 0.0;
  double damping_ = 0.0;
  double force_ = 0.0;
};

}  // namespace breakwater
