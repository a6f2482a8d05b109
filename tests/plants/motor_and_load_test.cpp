// Axes of one and of two inertias.
#include <Eigen/LU>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/plants/motor_and_load.h>
#include "support.h"

namespace breakwater::motor_and_load_test {
namespace {

using Complex = std::complex<double>;

const TwoInertia kPlant{.motor_inertia = 0.003,
                        .load_inertia = 0.05,
                        .stiffness = 80.0,
                        .damping = 0.02,
                        .motor_friction = 0.004,
                        .load_friction = 0.03,
                        .ratio = 3.0};

Complex response(const StateSpace& plant, const Eigen::VectorXd& input, double omega,
                 Eigen::Index output) {
  const Eigen::MatrixXcd resolvent =
      Complex(0.0, omega) * Eigen::MatrixXcd::Identity(4, 4) - plant.A.cast<Complex>();
  return resolvent.partialPivLu().solve(input.cast<Complex>())(output);
}

TEST(TwoInertia, RespondsAsItsEquationsOfMotion) {
  // The two equations as a 2×2 system in the positions, solved by Cramer's rule.
  const TwoInertia& p = kPlant;
  for (const Side side : {Side::motor, Side::load}) {
    const StateSpace plant = motor_and_load(p, side);
    const Eigen::Index motor = side == Side::motor ? 0 : 2, load = 2 - motor;
    for (const double omega : {1.0, 30.0, 60.0, 400.0}) {
      const Complex s(0.0, omega), k = p.stiffness + p.damping * s;
      const Complex a = p.motor_inertia * s * s + p.motor_friction * s + k / (p.ratio * p.ratio);
      const Complex b = p.load_inertia * s * s + p.load_friction * s + k;
      const Complex determinant = a * b - k * k / (p.ratio * p.ratio);
      const auto expect = [&](const Complex& found, const Complex& expected) {
        EXPECT_LT(std::abs(found - expected), 1e-11 * std::abs(expected)) << omega;
      };
      expect(response(plant, plant.B, omega, motor), b / determinant);
      expect(response(plant, plant.B, omega, load), k / p.ratio / determinant);
      expect(response(plant, load_torque_input(p, side), omega, load), a / determinant);
      expect(response(plant, load_torque_input(p, side), omega, motor), k / p.ratio / determinant);
    }
  }
}

TEST(TwoInertia, ResonancesAreEigenvaluesOfTheUndampedPlant) {
  TwoInertia undamped = kPlant;
  undamped.damping = undamped.motor_friction = undamped.load_friction = 0.0;
  const StateSpace plant = motor_and_load(undamped, Side::motor);
  EXPECT_NEAR(spectral_radius(plant.A), resonance_rad_s(undamped), 1e-6);
  // The motor stands still at the anti-resonance.
  const double omega = antiresonance_rad_s(undamped);
  EXPECT_LT(std::abs(response(plant, plant.B, omega, 0)), 1e-15);
}

TEST(TwoInertia, RefusesNonsense) {
  using Change = void (*)(TwoInertia&);
  for (const Change change : {
           Change([](TwoInertia& p) { p.motor_inertia = 0.0; }),
           Change([](TwoInertia& p) { p.load_inertia = -1.0; }),
           Change([](TwoInertia& p) { p.stiffness = 0.0; }),
           Change([](TwoInertia& p) { p.ratio = std::nan(""); }),
           Change([](TwoInertia& p) { p.damping = -1e-9; }),
           Change([](TwoInertia& p) { p.load_friction = INFINITY; }),
       }) {
    TwoInertia wrong = kPlant;
    change(wrong);
    EXPECT_REFUSED(motor_and_load(wrong, Side::motor));
    EXPECT_REFUSED(load_torque_input(wrong, Side::load));
  }
}

TEST(DampedInertia, SampledMatchesTheClosedForm) {
  const double M = 0.625, C = 0.78, T = 0.1;
  const StateSpace sampled = zero_order_hold(damped_inertia(M, C), T);
  const double decay = std::exp(-C / M * T);
  EXPECT_NEAR(sampled.A(0, 1), M / C * (1 - decay), 1e-15);
  EXPECT_NEAR(sampled.A(1, 1), decay, 1e-15);
  EXPECT_NEAR(sampled.B(1, 0), (1 - decay) / C, 1e-15);
  EXPECT_NEAR(sampled.B(0, 0), (T - M / C * (1 - decay)) / C, 1e-15);
}

TEST(DampedInertia, RefusesNonsense) {
  EXPECT_REFUSED(damped_inertia(0.0, 0.0));
  EXPECT_REFUSED(damped_inertia(1.0, -1.0));
  EXPECT_REFUSED(damped_inertia(std::nan(""), 0.0));
}

}  // namespace
}  // namespace breakwater::motor_and_load_test
