// The electric part of a drive: current loop, limits, ripple, steps of the PWM.
#pragma once

#include <cmath>

#include <breakwater/world/force_sensor.h>
#include <breakwater/world/position_sine.h>

namespace breakwater {

/// Each part is off at 0. Force stands for the torque of a motor that turns.
struct ElectricDrive {
  double bandwidth_rad_s = 0.0;  ///< ω of the current loop; 0: the current follows at once
  double damping_ratio = 0.0;    ///< ζ of the current loop; 0: it is of first order
  double torque_constant = 1.0;  ///< k [force/A], and of the back-EMF [V per velocity]
  double current_limit_A = 0.0;
  double voltage_limit_V = 0.0;
  double resistance_ohm = 0.0;  ///< R, needed by the voltage limit
  double inductance_H = 0.0;    ///< L
  PositionSine cogging;         ///< amplitude [force]
  PositionSine ripple;          ///< amplitude: ratio of the current's force

  bool is_on() const {
    return bandwidth_rad_s != 0.0 || current_limit_A != 0.0 || voltage_limit_V != 0.0 ||
           cogging.amplitude != 0.0 || ripple.amplitude != 0.0;
  }
};

/// A motor with its current loop. With the command F* and the velocity v,
///     i* = F*/k, within the current limit;
///     i follows i* by ω/(s + ω), or by ω²/(s² + 2 ζ ω s + ω²);
///     L di/dt = u − R i − k v with |u| ≤ U limits i to what this voltage reaches in a step;
///     F = k i (1 + r sin(n_r q)) + c sin(n_c q).
/// Loop and winding are discretised exactly for a command and a velocity that are held over each
/// step. The force of a step has the mean of the current: that of the exponential, and the
/// trapezoidal rule for a loop of second order. Beyond the speed of the voltage limit the motor
/// brakes. That limit is explicit in the velocity, so it needs h k²/(R m) < 2 with the mass or
/// inertia m.
class MotorDrive {
 public:
  /// Throws std::invalid_argument if a value is negative, k is not positive, or a voltage limit has
  /// no resistance.
  MotorDrive(const ElectricDrive& drive, double step_s);

  /// Advances the current by a step.
  void update(double command, double velocity);
  /// The force at a position, in the step of the last update().
  double force(double position) const;
  /// The current at the beginning of that step.
  const double& current_A() const { return current_A_; }

 private:
  // The current at the end of a step, without the limit of the voltage.
  double follow(double wanted_A);

  ElectricDrive drive_;
  double step_s_;
  Resonance second_order_;
  double decay_ = 0.0;          // over a step, for a loop of first order
  double part_before_ = 0.0;    // weight of the current before the step in its mean
  double winding_decay_ = 0.0;  // over a step, for the current of the winding alone
  double current_A_ = 0.0;
  double next_A_ = 0.0;
  double mean_A_ = 0.0;
};

/// Rounds a command to the nearest multiple of one step of the pulse width.
struct Pwm {
  double resolution = 0.0;  ///< one step, in the command's unit; 0: not quantised

  double output(double command) const {
    if (resolution == 0.0) return command;
    return resolution * std::round(command / resolution);
  }
};

}  // namespace breakwater
