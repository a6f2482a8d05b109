// Torque-limited soft contact (TLSC): as fast to the wall as the torques can stop again.
#pragma once

#include <vector>

#include <breakwater/control/arm_controller.h>
#include <breakwater/control/contact_stiffness.h>
#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/pfc.h>

namespace breakwater {

struct SoftContactDesign {
  Positioning positioning = Positioning::joint;  ///< before force control; workspace: the path
  std::vector<PfcDesign> joints;                 ///< of the positioning by joints
  PfcDesign hold;                                ///< of x at the start pose, on the path
  PfcDesign across;                              ///< of y and φ
  PfcDesign approach;                            ///< of the speed towards the wall
  PfcDesign contact;                             ///< of the way to go
  double wall_stiffness_N_m = 1000.0;            ///< K_d that the approach is prepared for
  double peak_margin_N = 2.2;                    ///< what the peak may exceed F^ref by
};

/// The largest speed at which a wall of stiffness K may be met, if the peak behind the force
/// sensor's lag τ may be F_allow, and a_b is what can be braked with:
///     F(v) = K (v t* − ½ a_b t*²),   t* = (τ + v/a_b)(1 − e^{−t*/τ}),  t* > 0,
/// which is where the lagged force of x = v t − ½ a_b t² has its maximum; and F(v) + K v t_d ≤
/// F_allow, as braking begins t_d after the contact. 0 if no speed is allowed.
double contact_speed(double stiffness_N_m, double braking_m_s2, double lag_s, double detection_s,
                     double allowed_N);

/// F(v) of it.
double contact_peak_N(double speed_m_s, double stiffness_N_m, double braking_m_s2, double lag_s);

/// The speed at which a proximate time-optimal servo goes to a point that is `way` ≥ 0 away: λ way
/// within a/(2λ²) of it, √(2 a way) − a/(2λ) beyond, where both have the same value and slope.
double servo_speed(double way_m, double acceleration_m_s2, double lambda);

/// A force law that plans with the torques that are left. With g = J⁺ e_x and r = J⁺([0, −k_p^y y −
/// k_d^y ẏ, −k_p^y φ − k_d^y φ̇]ᵀ − J̇ q̇), a path acceleration a_x needs the joints' accelerations
/// g a_x + r, so that a_x has the *authority* [lo, hi] = ∩_i ((±τ_lim,i − τ̂_d,i)/J_n,i − r_i)/g_i.
/// Four phases:
///  - positioning: each joint to q_0^ref (as the proposed method does), or
///  - hold: a_x = k_p (x_0 − x) − k_d ẋ on the path;
///  - approach: a_x = k_d (v_cap − ẋ), v_cap = contact_speed() of what can be braked with;
///  - contact: K is estimated (ContactStiffness), and with it the force without the sensor's lag,
///    hence the way to go ε = (F^ref − F̂)/K̂. The speed towards it is that of a proximate
///    time-optimal servo, v_d = √(2 a |ε|) − a/(2λ) far away and λ|ε| near, λ = k_p/k_d.
/// a_x is clipped to [lo, hi], so that y and φ keep the torques that they need, then each joint.
///
/// docs/explanation/methods/soft-contact.md has the derivation.
class SoftContact final : public ArmController {
 public:
  enum class Phase { positioning, hold, approach, contact };

  /// Throws std::invalid_argument where the parts do, if the chain has fewer than three joints, or
  /// K_d or the margin is not positive.
  SoftContact(const PlanarChain& chain, const AccelerationControlDesign& acceleration,
              const ArmTask& task, const SoftContactDesign& design);

 private:
  // The bounds of a_x.
  struct Authority {
    double lower;
    double upper;
  };

  void decide(Eigen::Ref<Eigen::VectorXd> a) override;
  void look_along_path();
  Authority authority() const;
  double braking_of_elbow(double inertia_kgm2) const;
  void identify_elbow();
  void detect_contact();
  double approach_acceleration();
  double contact_acceleration() const;

  SoftContactDesign design_;
  std::vector<Pfc> joint_pfc_;
  Pfc hold_, across_, approach_, contact_;
  Eigen::VectorXd inertia_;
  double period_s_;

  Phase phase_ = Phase::positioning;
  Eigen::Matrix<double, Eigen::Dynamic, 3> J_plus_;
  Eigen::VectorXd along_;      // g
  Eigen::VectorXd otherwise_;  // r
  TipPose velocity_ = TipPose::Zero();

  // The elbow's inertia, from its momentum since the approach began.
  double elbow_inertia_;
  double elbow_friction_ = 0.0;
  double elbow_impulse_ = 0.0;
  double elbow_speed_at_start_ = 0.0;
  double approach_s_ = 0.0;
  bool has_started_ = false;

  ContactStiffness stiffness_;
  double contact_x_m_ = 0.0;
  double unloaded_s_ = 0.0;

  // For the log.
  double way_to_go_m_ = 0.0;
  double speed_cap_m_s_ = 0.0;
  double stiffness_N_m_ = 0.0;
  Eigen::Vector2d authority_ = Eigen::Vector2d::Zero();
  double phase_number_ = 0.0;
};

}  // namespace breakwater
