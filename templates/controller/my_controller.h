// An admittance controller of the arm: in x the tip moves as a mass in a viscous fluid.
#pragma once

#include <Eigen/Core>

#include <breakwater/control/arm_controller.h>
#include <breakwater/rigs/arm_parts.h>

namespace my_controller_lab {

struct MyControllerDesign {
  double virtual_mass_kg = 2.0;
  double virtual_damping_Ns_m = 100.0;
  double k_p = 30.0;                   ///< position gain [1/s²]
  double singular_value_floor = 0.02;  ///< singular values below this count as 0
};

/// Before force control, each joint is held at its start angle:
///     a = K_p (q₀ − q̂) − 2 √K_p q̇̂ .
/// The start pose X₀ alone does not determine the side of the elbow, and the Jacobian of the
/// stretched arm does not either. In force control the tip's x is an admittance, driven by the
/// force error:
///     M ẍ + D ẋ = F^ref − F .
/// It approaches the wall at F^ref/D and comes to rest at F = F^ref. y and φ are held:
///     Ẍ = K_p (X₀ − X̂) − 2 √K_p Ẋ .
/// The accelerations of the joints are a = J⁺ (Ẍ − J̇ q̇). ArmController converts them to torques.
/// Its disturbance observer compensates friction, coupling and the contact force.
class MyController final : public breakwater::ArmController {
 public:
  /// Throws std::invalid_argument if mass or damping is not positive or a gain is negative.
  MyController(const breakwater::ArmSetup& arm, const MyControllerDesign& design);

 private:
  void decide(Eigen::Ref<Eigen::VectorXd> a) override;

  MyControllerDesign design_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> J_plus_;
  double virtual_acceleration_m_s2_ = 0.0;
};

/// The controller for the catalogue: its name, its keys, and the function that makes it.
breakwater::ArmControllerKind my_controller_kind();

}  // namespace my_controller_lab
