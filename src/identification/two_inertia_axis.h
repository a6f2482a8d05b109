// A motor and a load with a spring, backlash and friction, driven by a recorded input.
#pragma once

#include <breakwater/identification/axis_model.h>
#include <breakwater/plants/motor_and_load.h>

namespace breakwater {

/// The plant of the scenario two_inertia with the ratio 1,
///     J_m v̇_m = k u(t − τ) − d₀ − c_m v_m − F_m sgn(v_m) − T,   q̇_m = v_m,
///     J_l v̇_l = T − c_l v_l − F_l sgn(v_l),                      q̇_l = v_l,
/// with the torque T of sim/transmission.h. Beyond a play b, T = K z + D (v_m − v_l) and never
/// pulls. Without a play, T = K (q_m − q_l) + D (v_m − v_l). Each side sticks at v = 0 while the
/// torques on it are at most its Coulomb friction.
///
/// Between events the plant is linear, and a Taylor polynomial moves it. A step is at most half the
/// time constant of the fastest motion. Its error is below 1e-9 of its size. The time of each
/// event (reversal, stick, slip, contact of a flank) is the root of a polynomial. The motor or the
/// load has the encoder. Its position is NaN if more than 100 steps a row are needed. The twist of
/// a start is q_m − q_l.
const AxisModel& two_inertia_axis(Side measured);

}  // namespace breakwater
