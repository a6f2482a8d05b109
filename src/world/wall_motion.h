// The motion of a wall along its normal.
#pragma once

#include <breakwater/math/table_function.h>
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
  double start_s = 0.0;          ///< ramp and sine
  double speed_m_s = 0.0;        ///< ramp
  double amplitude_m = 0.0;      ///< sine
  double frequency_rad_s = 0.0;  ///< sine
  math::TableFunction table;     ///< csv: positions [m]
  double mass_kg = 1.0;          ///< free
  double stiffness_N_m = 0.0;
  double damping_Ns_m = 0.0;

  /// A function of time alone; a free wall is at rest at 0. Between two rows of a table it moves
  /// evenly, and beyond them it stands.
  WallPosition at(double time_s) const;
};

}  // namespace breakwater
