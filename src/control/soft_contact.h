// Torque-limited soft contact (TLSC): an approach as fast as the torque limits can brake.
#pragma once

#include <vector>

#include <breakwater/control/arm_controller.h>
#include <breakwater/control/contact_stiffness.h>
#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/pfc.h>

namespace breakwater {

struct SoftContactDesign {
  Positioning positioning = Positioning::joint;  ///< before force control
  std::vector<PfcDesign> joints;                 ///< positioning by joints
  PfcDesign hold;                                ///< x at the start pose, along the path
  PfcDesign across;                              ///< y and φ
  PfcDesign approach;                            ///< speed towards the wall
  PfcDesign contact;                             ///< way to go
  double wall_stiffness_N_m = 1000.0;            ///< design stiffness K_d
  double peak_margin_N = 2.2;                    ///< allowed excess of the peak over F^ref
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

/// A force controller that plans with the remaining torques. A path acceleration a_x needs the
/// joint accelerations g a_x + r, with
///     g = J⁺ e_x,   r = J⁺([0, −k_p^y y − k_d^y ẏ, −k_p^y φ − k_d^y φ̇]ᵀ − J̇ q̇).
/// The *authority* of a_x is [lo, hi] = ∩_i ((±τ_lim,i − τ̂_d,i)/J_n,i − r_i)/g_i.
/// Four phases:
///  - positioning: each joint to q_0^ref (as the proposed method does), or
///  - hold: a_x = k_p (x_0 − x) − k_d ẋ on the path;
///  - approach: a_x = k_d (v_cap − ẋ), v_cap = contact_speed() of the available deceleration;
///  - contact: ContactStiffness estimates K and the force without the sensor's lag. The way to go
///    is ε = (F^ref − F̂)/K̂. The speed towards it is that of a proximate time-optimal servo:
///    v_d = √(2 a |ε|) − a/(2λ) far away and λ|ε| near, λ = k_p/k_d.
/// a_x is clipped to [lo, hi], so that y and φ keep their torques. Then each joint is clipped.
///
/// Derivation: docs/explanation/methods/soft-contact.md.
class SoftContact final : public ArmController {
 public:
  enum class Phase { positioning, hold, approach, contact };

  /// Throws std::invalid_argument as the parts do, if the chain has fewer than three joints, or if
  /// K_d or the margin is not positive.
  SoftContact(const PlanarChain& chain, const AccelerationControlDesign& acceleration,
              const ArmTask& task, const SoftContactDesign& design);

 private:
  // Bounds of a_x.
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

  // The elbow's inertia, from its momentum since the start of the approach.
  double elbow_inertia_;
  double elbow_friction_ = 0.0;
  double elbow_impulse_ = 0.0;
  double elbow_speed_at_start_ = 0.0;
  double approach_s_ = 0.0;
  bool has_started_ = false;

  ContactStiffness stiffness_;
  double contact_x_m_ = 0.0;
  double unloaded_s_ = 0.0;

  // Signals for the log.
  double way_to_go_m_ = 0.0;
  double speed_cap_m_s_ = 0.0;
  double stiffness_N_m_ = 0.0;
  Eigen::Vector2d authority_ = Eigen::Vector2d::Zero();
  double phase_number_ = 0.0;
};

}  // namespace breakwater
