// An admittance controller of the arm: in x the tip moves as a mass in a viscous fluid would.
#pragma once

#include <Eigen/Core>

#include <breakwater/control/arm_controller.h>
#include <breakwater/rigs/arm_parts.h>

namespace my_controller_lab {

struct MyControllerDesign {
  double virtual_mass_kg = 2.0;
  double virtual_damping_Ns_m = 100.0;
  double k_p = 30.0;                   ///< of what is held [1/s²]
  double singular_value_floor = 0.02;  ///< of the pseudo-inverse
};

/// Until force control begins, each joint is held at its start angle,
///     a = K_p (q₀ − q̂) − 2 √K_p q̇̂ :
/// the start pose X₀ alone would not say which way the elbow is bent, and from the stretched arm
/// the Jacobian does not know it. From then on the tip's x is an admittance, driven by what the
/// force lacks,
///     M ẍ + D ẋ = F^ref − F,
/// so that it approaches the wall at F^ref/D and comes to rest where F = F^ref; y and φ stay held,
///     Ẍ = K_p (X₀ − X̂) − 2 √K_p Ẋ .
/// The joints' accelerations are then a = J⁺ (Ẍ − J̇ q̇). ArmController makes torques of them: its
/// disturbance observer takes friction, coupling and the contact force away.
class MyController final : public breakwater::ArmController {
 public:
  /// Throws std::invalid_argument unless mass and damping are positive and the rest is not
  /// negative, or as ArmController does.
  MyController(const breakwater::ArmSetup& arm, const MyControllerDesign& design);

 private:
  void decide(Eigen::Ref<Eigen::VectorXd> a) override;

  MyControllerDesign design_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> J_plus_;
  double virtual_acceleration_m_s2_ = 0.0;
};

/// For the catalogue: its name, its keys, and how it is made of them.
breakwater::ArmControllerKind my_controller_kind();

}  // namespace my_controller_lab
