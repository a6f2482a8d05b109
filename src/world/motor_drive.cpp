#include <breakwater/world/motor_drive.h>

#include <algorithm>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {

MotorDrive::MotorDrive(const ElectricDrive& drive, double step_s)
    : drive_(drive),
      step_s_(step_s),
      second_order_({drive.damping_ratio > 0.0 ? drive.bandwidth_rad_s : 0.0, drive.damping_ratio},
                    step_s) {
  refuse_unless(is_not_negative(drive.bandwidth_rad_s) && is_not_negative(drive.damping_ratio) &&
                    is_not_negative(drive.current_limit_A) &&
                    is_not_negative(drive.voltage_limit_V) &&
                    is_not_negative(drive.resistance_ohm) && is_not_negative(drive.inductance_H) &&
                    step_s > 0.0,
                "drive: its values must be finite and not negative");
  refuse_unless(is_positive(drive.torque_constant), "drive: needs a torque constant > 0");
  refuse_unless(drive.voltage_limit_V == 0.0 || drive.resistance_ohm > 0.0,
                "drive: a voltage limit needs a resistance > 0");
  if (drive.bandwidth_rad_s > 0.0) {
    const double turn = drive.bandwidth_rad_s * step_s;
    decay_ = math::exp(-turn);
    const double rise = -math::expm1(-turn);
    part_before_ = drive.damping_ratio > 0.0 ? 0.5 : 1.0 / turn - decay_ / rise;
  }
  if (drive.inductance_H > 0.0) {
    winding_decay_ = math::exp(-drive.resistance_ohm * step_s / drive.inductance_H);
  }
}

double MotorDrive::follow(double wanted_A) {
  if (drive_.bandwidth_rad_s == 0.0) return wanted_A;
  if (drive_.damping_ratio > 0.0) return second_order_.update(wanted_A);
  return wanted_A + (current_A_ - wanted_A) * decay_;
}

void MotorDrive::update(double command, double velocity) {
  current_A_ = next_A_;
  double wanted_A = command / drive_.torque_constant;
  if (drive_.current_limit_A > 0.0) {
    wanted_A = std::clamp(wanted_A, -drive_.current_limit_A, drive_.current_limit_A);
  }
  next_A_ = follow(wanted_A);
  if (drive_.voltage_limit_V > 0.0) {
    const double own_A = current_A_ * winding_decay_;
    const double gain = (1.0 - winding_decay_) / drive_.resistance_ohm;
    const double back_emf_V = drive_.torque_constant * velocity;
    const double reached_A =
        std::clamp(next_A_, own_A + gain * (-drive_.voltage_limit_V - back_emf_V),
                   own_A + gain * (drive_.voltage_limit_V - back_emf_V));
    if (reached_A != next_A_) second_order_.set(reached_A, (reached_A - current_A_) / step_s_);
    next_A_ = reached_A;
  }
  mean_A_ = next_A_ + part_before_ * (current_A_ - next_A_);
}

double MotorDrive::force(double position) const {
  return drive_.torque_constant * mean_A_ * (1.0 + drive_.ripple.value(position)) +
         drive_.cogging.value(position);
}

}  // namespace breakwater
