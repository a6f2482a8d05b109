// Torque-limited soft contact (TLSC): an approach as fast as the torque limits can brake.
#pragma once

#include <Eigen/Core>

#include <breakwater/control/path_control.h>

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

struct SoftContactDesign {
  PathDesign path;
  Pfc contact;  ///< way to go
};

/// The largest impact velocity v at a wall of stiffness K for which the peak behind the sensor's
/// lag τ stays below F_allow. a_b is the available deceleration:
///     F(v) = K (v t* − ½ a_b t*²),   t* = (τ + v/a_b)(1 − e^{−t*/τ}),  t* > 0,
/// This is the maximum of the lagged force for x = v t − ½ a_b t². Braking begins t_d after the
/// contact, so F(v) + K v t_d ≤ F_allow. Returns 0 if no speed is allowed.
double contact_speed(double stiffness_N_m, double braking_m_s2, double lag_s, double detection_s,
                     double allowed_N);

/// F(v) of contact_speed().
double contact_peak_N(double speed_m_s, double stiffness_N_m, double braking_m_s2, double lag_s);

/// Speed command of a proximate time-optimal servo at the distance `way` ≥ 0: λ way up to a/(2λ²),
/// and √(2 a way) − a/(2λ) beyond. Both have the same value and slope there.
double servo_speed(double way_m, double acceleration_m_s2, double lambda);

/// A force controller that plans with the remaining torques, the authority of PathControl. Four
/// phases:
///  - positioning: each joint to q_0^ref (as the proposed method does), or
///  - hold: a_x = k_p (x_0 − x) − k_d ẋ on the path;
///  - approach: a_x = k_d (v_cap − ẋ), v_cap = contact_speed() of the available deceleration;
///  - contact: ContactStiffness estimates K and the force without the sensor's lag. The way to go
///    is ε = (F^ref − F̂)/K̂. The speed towards it is that of a proximate time-optimal servo:
///    v_d = √(2 a |ε|) − a/(2λ) far away and λ|ε| near, λ = k_p/k_d.
///
/// Derivation: docs/explanation/methods/soft-contact.md.
class SoftContact final : public PathControl {
 public:
  enum class Phase { positioning, hold, approach, contact };

  /// Throws std::invalid_argument as the parts do.
  SoftContact(const ArmSetup& arm, const SoftContactDesign& design);

 private:
  void decide(Eigen::Ref<Eigen::VectorXd> a) override;
  double path_acceleration() override;
  double braking_of_elbow(double inertia_kgm2) const;
  void identify_elbow();
  void follow_stiffness();
  double approach_acceleration();
  double contact_acceleration() const;

  SoftContactDesign design_;
  Phase phase_ = Phase::positioning;

  // The elbow's inertia, from its momentum since the start of the approach.
  Eigen::Index elbow_;
  double elbow_inertia_;
  double elbow_friction_ = 0.0;
  double elbow_impulse_ = 0.0;
  double elbow_speed_at_start_ = 0.0;
  double approach_s_ = 0.0;
  bool has_started_ = false;

  ContactStiffness stiffness_;

  // Signals for the log.
  double way_to_go_m_ = 0.0;
  double speed_cap_m_s_ = 0.0;
  double stiffness_N_m_ = 0.0;
  double phase_number_ = 0.0;
};

}  // namespace breakwater
