// The motion of a wall along its normal.
#pragma once

#include <breakwater/world/disturbance.h>

namespace breakwater {

enum class WallMotionKind { fixed, ramp, sine, csv, free };

/// How far a wall has moved along its normal, away from what strikes it.
struct WallPosition {
  double position_m = 0.0;
  double speed_m_s = 0.0;
};

/// A wall that stands, moves as a function of time, or is a mass on a spring and a damper.
struct WallMotion {
  WallMotionKind kind = WallMotionKind::fixed;
  Disturbance ramp{.kind = DisturbanceKind::ramp};  ///< each has a position [m] as its value
  Disturbance sine{.kind = DisturbanceKind::sine};
  Disturbance csv{.kind = DisturbanceKind::csv, .amplitude = 1.0};
  double mass_kg = 1.0;  ///< free
  double stiffness_N_m = 0.0;
  double damping_Ns_m = 0.0;

  /// A function of time alone; a free wall is at rest at 0. Between two rows of a table it moves
  /// evenly, and beyond them it stands.
  WallPosition at(double time_s) const {
    if (kind == WallMotionKind::fixed || kind == WallMotionKind::free) return {};
    const Disturbance& path = kind == WallMotionKind::ramp   ? ramp
                              : kind == WallMotionKind::sine ? sine
                                                             : csv;
    return {path.value(time_s), path.rate(time_s)};
  }
};

}  // namespace breakwater
