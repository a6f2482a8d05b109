// An axis with friction that sticks, driven by a recorded input, for fits to records.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace breakwater {

/// Parameters of an axis in SI units (N m and rad, or N and m).
enum AxisParameter : std::size_t {
  kInertia,
  kViscous,
  kCoulomb,
  kBreakaway,      ///< friction at v = 0 beyond the Coulomb friction (Stribeck)
  kStribeckSpeed,  ///< v_s
  kOffset,
  kDelay,
  kTorqueConstant,  ///< scale of the recorded input
  kAxisParameters
};
using AxisValues = std::array<double, kAxisParameters>;

/// A part of a record without a long gap. Input i acts from input_times_s[i] to the next of these
/// times, and the last one until the end.
struct AxisStretch {
  std::vector<double> input_times_s;
  std::vector<double> inputs;
  std::vector<double> times_s;  ///< times of the positions; the first is that of the initial state
  std::vector<double> positions;  ///< as measured
};

/// Position and velocity at the beginning of a stretch.
struct AxisStart {
  double position = 0.0;
  double velocity = 0.0;
};

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
