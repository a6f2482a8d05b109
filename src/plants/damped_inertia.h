// A plant with one inertia: thesis 2.2.1 (a motor) and 2.3 (a cart).
#pragma once

#include <breakwater/linear/state_space.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

/// J q̈ = τ − c q̇ with measured position (Eqs. 2.1–2.3; cart: Eqs. 2.32–2.35). x = [q; q̇], A = [0
/// 1; 0 −c/J], B = [0; 1/J], C = [1 0]. Units: J in kg m² and c in N m s/rad, or kg and N s/m.
/// Throws std::invalid_argument unless J is positive and c not negative.
inline StateSpace damped_inertia(double inertia, double viscous_friction) {
  refuse_unless(inertia > 0.0 && viscous_friction >= 0.0,
                "plant: needs an inertia > 0 and a viscous friction >= 0");
  StateSpace plant{Eigen::Matrix2d::Zero(), Eigen::Vector2d(0.0, 1.0 / inertia),
                   Eigen::RowVector2d(1.0, 0.0)};
  plant.A(0, 1) = 1.0;
  plant.A(1, 1) = -viscous_friction / inertia;
  return plant;
}

}  // namespace breakwater
