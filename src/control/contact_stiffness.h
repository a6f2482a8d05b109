// Stiffness and damping of a contact, from a lagged force.
#pragma once

#include <Eigen/Core>

namespace breakwater {

/// Estimates K and B of F = K δ + B δ̇, of which only F_f is measured, behind a first-order lag τ. δ
/// and δ̇ are sent through the same lag, so that F_f = K δ_f + B v_f holds exactly, and K and B are
/// fitted by least squares with the priors K = 1000 ± 3000 N/m, B = 0 ± 30 N s/m and a noise of
/// 0.05 N. What comes before 4 ms of contact, or after 350 ms, does not count. K is kept within
/// [200, 2e5] N/m.
class ContactStiffness {
 public:
  /// Throws std::invalid_argument unless the lag is not negative and the period positive.
  ContactStiffness(double lag_s, double period_s);

  /// A contact begins.
  void reset();

  /// A sample of the contact: depth δ [m], its rate [m/s] and F_f [N]. Allocates nothing.
  void update(double depth_m, double rate_m_s, double force_N);

  double stiffness_N_m() const { return stiffness_; }
  double damping_Ns_m() const { return damping_; }
  /// The force now, without the lag: F̂ = K̂ δ + (F_f − K̂ δ_f).
  double force_N() const { return force_; }

 private:
  double period_s_;
  double forget_;  // of the lag, a sample: e^{−T_s/τ}
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
