// An axis with friction that sticks, driven by a recorded input, for fits to records.
#pragma once

#include <breakwater/identification/axis_model.h>

namespace breakwater {

/// Integrates
///     J v̇ = k u(t − τ) − d₀ − c v − sgn(v) (F_C + F_B exp(−(v/v_s)²)),   q̇ = v,
/// exactly between changes of the input, of the sign of v, and of stick to slip. At v = 0 the axis
/// sticks while |k u − d₀| ≤ F_C + F_B. With F_B ≠ 0, steps of at most v_s/5 linearise the friction
/// (Rosenbrock–Euler). `positions` gets q at each of stretch.times_s.
///
/// Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083–1138,
/// Eqs. 3 and 7.
void move_axis(const AxisValues& parameters, const AxisStart& start, const AxisStretch& stretch,
               std::span<double> positions);

}  // namespace breakwater
