// Control of the arm along a path: the tip moves in x and holds its other coordinates.
#pragma once

#include <vector>

#include <breakwater/control/arm_controller.h>
#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/pfc.h>

namespace breakwater {

/// The numbers by which a controller limits the impact on a spring.
struct ImpactModel {
  double stiffness_N_m = 1000.0;  ///< K of the contact, as the controller knows it
  double peak_margin_N = 2.2;     ///< allowed excess of the peak over F^ref

  /// F_peak, for the reference F^ref [N].
  double allowed_N(double reference_N) const { return reference_N + peak_margin_N; }
};

struct PathDesign {
  Positioning positioning = Positioning::joint;  ///< before force control
  std::vector<Pfc> joints;                       ///< positioning by joints
  Pfc hold;                                      ///< x at the start pose, along the path
  Pfc across;                                    ///< the other coordinates
  Pfc approach;                                  ///< speed towards the wall
  ImpactModel impact;                            ///< limits the speed
};

/// The common part of the controllers that reach the wall on a path. A path acceleration a_x needs
/// the joint accelerations g a_x + r, with
///     g = J⁺ e_x,   r = J⁺([0, −k_p^y y − k_d^y ẏ, −k_p^y φ − k_d^y φ̇]ᵀ − J̇ q̇)
/// for the coordinates x, y, φ, and so on for each other coordinate.
/// The *authority* of a_x is [lo, hi] = ∩_i ((±τ_lim,i − τ̂_d,i)/J_n,i − r_i)/g_i. Before force
/// control the arm holds its start pose. In force control, a derived class chooses a_x. It is
/// clipped to [lo, hi], so that the others keep their torques. Then each joint is clipped.
class PathControl : public ArmController {
 protected:
  /// Throws std::invalid_argument as the parts do, or if K or the margin is not positive.
  PathControl(const ArmSetup& arm, const PathDesign& design);

  void restart() override { touches_ = false; }
  void decide(Eigen::Ref<Eigen::VectorXd> a) override;

  /// a_x [m/s²] in force control, before it is clipped. Called once a sample.
  virtual double path_acceleration() = 0;

  const PathDesign& path() const { return path_; }
  /// Whether the tip touches the wall. Contact begins at a raw force of 0.15 N. It ends with force
  /// control, or when raw and filtered force have been below this value for 80 ms.
  bool touches() const { return touches_; }
  double contact_x_m() const { return contact_x_m_; }  ///< x̂ at the beginning of the last contact

  /// The effective mass of the tip along x, with every joint free to recoil and the nominal
  /// inertia of the joints:  m = 1/(J_x M_n⁻¹ J_xᵀ) [kg] (Khatib, Int. J. Robotics Research 14
  /// (1995) 19–36).
  double effective_mass_kg();

  static constexpr double kSmallestShare = 1e-6;  ///< smallest |g_i| of a joint that bounds a_x
  static constexpr double kLeastAuthority_m_s2 = 0.3;  ///< lower bound for planning

  Eigen::VectorXd inertia_;              // diagonal of J_n
  Eigen::VectorXd along_;                // g
  Eigen::VectorXd otherwise_;            // r
  Eigen::VectorXd recoil_;               // M_n⁻¹ J_xᵀ of coupled joints
  TipVector wanted_;                     // r = J⁺ wanted
  TipVector velocity_;                   // J q̇
  Eigen::Vector2d authority_{0.0, 0.0};  // limits of a_x: to brake and to drive, both positive

 private:
  void look_along_path();
  void follow_contact();
  void measure_authority();

  PathDesign path_;
  Eigen::VectorXd share_, rest_;      // limited_part() of g and r
  double lower_ = 0.0, upper_ = 0.0;  // lo and hi
  bool is_possible_ = false;          // lo ≤ hi
  bool touches_ = false;
  double contact_x_m_ = 0.0;
  double unloaded_s_ = 0.0;
};

}  // namespace breakwater
