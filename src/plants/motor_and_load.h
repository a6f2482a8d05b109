// A plant with two inertias: a motor that drives a load through a spring.
#pragma once

#include <breakwater/linear/state_space.h>

namespace breakwater {

/// The numbers of the plant. Units: kg m², N m/rad, N m s/rad; or kg, N/m, N s/m for a motor and a
/// load that slide.
struct TwoInertia {
  double motor_inertia = 0.0;   ///< J_m
  double load_inertia = 0.0;    ///< J_l
  double stiffness = 0.0;       ///< K, of the twist at the load
  double damping = 0.0;         ///< D, of the twist's rate
  double motor_friction = 0.0;  ///< c_m, viscous
  double load_friction = 0.0;   ///< c_l, viscous
  double ratio = 1.0;           ///< N: motion of the motor for one of the load
};

/// Throws std::invalid_argument unless the inertias, the stiffness and the ratio are positive, the
/// other numbers are not negative and all are finite.
void check(const TwoInertia& plant);

enum class Side { motor, load };

/// J_m q̈_m = τ − T/N − c_m q̇_m,   J_l q̈_l = T − d − c_l q̇_l,
/// T = K (q_m/N − q_l) + D (q̇_m/N − q̇_l),
/// with the input τ. The states are the position and velocity of the measured side, then those of
/// the other side. The output is the position of the measured side. Throws as check() does.
StateSpace motor_and_load(const TwoInertia& plant, Side measured);

/// E (4×1) of ẋ = A x + B τ − E d, for the same states: d opposes the load. Throws as check() does.
Eigen::VectorXd load_torque_input(const TwoInertia& plant, Side measured);

/// ω_a = √(K/J_l), at which the undamped motor stands still under a torque of this frequency.
double antiresonance_rad_s(const TwoInertia& plant);
/// ω_r = √(K (1/(N² J_m) + 1/J_l)), at which the undamped plant vibrates freely.
double resonance_rad_s(const TwoInertia& plant);

}  // namespace breakwater
