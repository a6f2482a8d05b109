// A plant with one inertia: thesis 2.2.1 (a motor) and 2.3 (a cart).
#pragma once

#include <breakwater/linear/state_space.h>

namespace breakwater {

/// J q̈ = τ − c q̇ with measured position (Eqs. 2.1–2.3; cart: Eqs. 2.32–2.35). x = [q; q̇], A = [0
/// 1; 0 −c/J], B = [0; 1/J], C = [1 0]. Units: J in kg m² and c in N m s/rad, or kg and N s/m.
/// Throws std::invalid_argument unless J is positive and c not negative.
StateSpace damped_inertia(double inertia, double viscous_friction);

}  // namespace breakwater
