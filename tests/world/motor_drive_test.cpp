#include <breakwater/world/motor_drive.h>

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <stdexcept>

#include <breakwater/world/encoder.h>

namespace breakwater {
namespace {

constexpr double kMotorStep_s = 1e-4;

// The step response of ω²/(s² + 2 ζ ω s + ω²), for any ζ but 1 by its two poles.
double second_order(double omega, double zeta, double t) {
  if (zeta == 1.0) return 1.0 - std::exp(-omega * t) * (1.0 + omega * t);
  using Complex = std::complex<double>;
  const Complex root = std::sqrt(Complex(zeta * zeta - 1.0));
  const Complex a = omega * (-zeta + root), b = omega * (-zeta - root);
  return std::real(1.0 + (b * std::exp(a * t) - a * std::exp(b * t)) / (a - b));
}

TEST(MotorDrive, TheCurrentLoopHasTheStepResponseOfItsClosedForm) {
  for (const double omega : {50.0, 1000.0, 3e4}) {
    for (const double zeta : {0.0, 0.3, 0.7, 1.0, 2.5}) {
      MotorDrive motor({.bandwidth_rad_s = omega, .damping_ratio = zeta, .torque_constant = 0.5},
                       kMotorStep_s);
      for (int k = 0; k < 300; ++k) {
        motor.update(1.0, 0.0);  // i* = 2 A
        const double t = k * kMotorStep_s;
        const double exact = zeta == 0.0 ? -std::expm1(-omega * t) : second_order(omega, zeta, t);
        ASSERT_NEAR(motor.current_A(), 2.0 * exact, 2e-7) << omega << ' ' << zeta << ' ' << k;
      }
    }
  }
}

TEST(MotorDrive, TheForceOfALoopOfFirstOrderHasTheMeanCurrentOfItsStep) {
  for (const double omega : {50.0, 1000.0, 3e4}) {
    MotorDrive motor({.bandwidth_rad_s = omega}, kMotorStep_s);
    double impulse = 0.0;
    for (int k = 0; k < 200; ++k) {
      motor.update(1.0, 0.0);
      impulse += kMotorStep_s * motor.force(0.0);
    }
    const double t = 200 * kMotorStep_s;
    EXPECT_NEAR(impulse, t + std::expm1(-omega * t) / omega, 1e-12);
  }
}

TEST(MotorDrive, LimitsTheReferenceOfItsCurrent) {
  MotorDrive motor({.torque_constant = 2.0, .current_limit_A = 3.0}, kMotorStep_s);
  for (const double command : {4.0, 7.0, -9.0}) {
    motor.update(command, 0.0);
    EXPECT_EQ(motor.force(0.0), std::clamp(command, -6.0, 6.0));
  }
}

TEST(MotorDrive, AVoltageLimitGivesTheCurrentOfTheWinding) {
  // At a constant velocity, L di/dt = U − R i − k v from i = 0.
  const double U = 24.0, R = 2.0, L = 0.01, k = 0.5, v = 10.0;
  MotorDrive motor(
      {.torque_constant = k, .voltage_limit_V = U, .resistance_ohm = R, .inductance_H = L},
      kMotorStep_s);
  for (int n = 0; n < 200; ++n) {
    motor.update(100.0, v);
    ASSERT_NEAR(motor.current_A(), -(U - k * v) / R * std::expm1(-R / L * n * kMotorStep_s), 1e-12);
  }
}

TEST(MotorDrive, AVoltageLimitGivesTheTopSpeedOfItsClosedForm) {
  // k (U − k v)/R = b v.
  const double U = 24.0, R = 2.0, k = 0.5, b = 0.1, mass = 0.2;
  for (const double inductance_H : {0.0, 0.01}) {
    for (const double bandwidth_rad_s : {0.0, 500.0}) {
      for (const double zeta : {0.0, 0.7}) {
        MotorDrive motor({.bandwidth_rad_s = bandwidth_rad_s,
                          .damping_ratio = zeta,
                          .torque_constant = k,
                          .voltage_limit_V = U,
                          .resistance_ohm = R,
                          .inductance_H = inductance_H},
                         kMotorStep_s);
        double v = 0.0;
        for (int n = 0; n < 200000; ++n) {
          motor.update(100.0, v);
          v += kMotorStep_s / mass * (motor.force(0.0) - b * v);
        }
        EXPECT_NEAR(v, k * U / (k * k + b * R), 1e-6) << inductance_H << ' ' << bandwidth_rad_s;
      }
    }
  }
}

TEST(MotorDrive, BrakesBeyondTheSpeedOfItsVoltage) {
  MotorDrive motor({.torque_constant = 0.5, .voltage_limit_V = 10.0, .resistance_ohm = 2.0},
                   kMotorStep_s);
  motor.update(1.0, 30.0);
  EXPECT_DOUBLE_EQ(motor.force(0.0), 0.5 * (10.0 - 15.0) / 2.0);
}

TEST(MotorDrive, CoggingAndRippleAreSinesOfThePosition) {
  MotorDrive motor({.cogging = {.amplitude = 0.3, .periods = 12.0},
                    .ripple = {.amplitude = 0.05, .periods = 6.0}},
                   kMotorStep_s);
  motor.update(2.0, 0.0);
  for (double angle = -4.0; angle < 4.0; angle += 0.1) {
    EXPECT_NEAR(motor.force(angle),
                2.0 * (1.0 + 0.05 * std::sin(6.0 * angle)) + 0.3 * std::sin(12.0 * angle), 1e-12);
  }
}

TEST(MotorDrive, RefusesWhatIsNoMotor) {
  const std::vector<ElectricDrive> wrong = {
      {.bandwidth_rad_s = -1.0},
      {.bandwidth_rad_s = 1.0, .damping_ratio = -1.0},
      {.torque_constant = 0.0},
      {.current_limit_A = -1.0},
      {.voltage_limit_V = std::nan("")},
      {.voltage_limit_V = 1.0},
      {.voltage_limit_V = 1.0, .resistance_ohm = -1.0},
      {.voltage_limit_V = 1.0, .resistance_ohm = 1.0, .inductance_H = -1.0}};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_THROW(MotorDrive(wrong[i], kMotorStep_s), std::invalid_argument) << i;
  }
}

TEST(Encoder, TheErrorsOfItsScaleAreSinesOfTheTruePosition) {
  Encoder encoder{.quantum = 1e-4};
  encoder.eccentricity = {.amplitude = 2e-3, .periods = 1.0};
  encoder.interpolation = {.amplitude = 5e-4, .periods = 1024.0};
  for (double angle = -4.0; angle < 4.0; angle += 0.0137) {
    const double error = 2e-3 * std::sin(angle) + 5e-4 * std::sin(1024.0 * angle);
    EXPECT_NEAR(encoder.error(angle), error, 1e-15);
  }
  PositionSine scale{.amplitude = 1e-6, .periods = 50.0, .length = 1.0};  // 50 periods in a metre
  EXPECT_NEAR(scale.value(0.005), 1e-6 * std::sin(0.5 * std::numbers::pi), 1e-18);
}

}  // namespace
}  // namespace breakwater
