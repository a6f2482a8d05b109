#include <breakwater/observers/mdob.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace breakwater {
namespace {

Eigen::VectorXd number(double value) {
  return Eigen::VectorXd::Constant(1, value);
}

// An observer after a sample with angle 0 at rest.
void begin(Mdob& observer) {
  observer.reset(Eigen::Vector2d::Zero());
  observer.update(number(NAN), number(0.0));
}

TEST(Mdob, AtRestEstimatesTheFilteredTorque) {
  // q = 0 under torque τ: the disturbance is τ, its estimate τ (1 − e^{−g_w t}), exact at samples.
  const double T = 1e-3, g_w = 80.0, torque = 7.0;
  Mdob observer({1.5, 300.0, g_w}, T);
  begin(observer);
  for (int k = 1; k <= 100; ++k) {
    observer.update(number(torque), number(0.0));
    EXPECT_NEAR(observer.disturbance()(0), torque * -std::expm1(-g_w * k * T), 1e-12);
  }
}

TEST(Mdob, EstimatesZeroOnItsNominalPlant) {
  // Free acceleration: τ = J q̈ needs no disturbance. The error vanishes with the period.
  const double J = 0.8, torque = 2.0;
  double previous = 1e300;
  for (const double T : {1e-3, 1e-4, 1e-5}) {
    Mdob observer({J, 1e4, 100.0}, T);
    begin(observer);
    double largest_late = 0.0;
    const int steps = static_cast<int>(std::lround(0.3 / T));
    for (int k = 1; k <= steps; ++k) {
      const double t = k * T;
      observer.update(number(torque), number(0.5 * torque / J * t * t));
      if (t > 0.2) largest_late = std::max(largest_late, std::abs(observer.disturbance()(0)));
    }
    EXPECT_LT(largest_late, 0.5 * previous);
    previous = largest_late;
  }
  EXPECT_LT(previous, 0.02 * torque);
}

TEST(Mdob, FindsAConstantDisturbanceWithTheSignOfEq253) {
  // J q̈ = τ − d with τ = 0: the disturbance pushes the joint back, so d̂ must be positive.
  const double T = 1e-4, J = 1.0, d = 10.0;
  Mdob observer({J, 2000.0, 50.0}, T);
  begin(observer);
  for (int k = 1; k <= 10000; ++k) {
    const double t = k * T;
    observer.update(number(0.0), number(-0.5 * d / J * t * t));
  }
  EXPECT_NEAR(observer.disturbance()(0), d, 0.05);
  EXPECT_NEAR(observer.state()(1), -d / J, 0.02);
}

TEST(Mdob, ARawDifferenceIsOne) {
  Mdob observer({1.0, INFINITY, 50.0}, 1e-3);
  observer.reset(Eigen::Vector2d::Zero());
  observer.update(number(0.0), number(0.5));
  EXPECT_EQ(observer.state()(1), 0.0);  // one sample gives no difference
  observer.update(number(0.0), number(0.7));
  EXPECT_NEAR(observer.state()(1), 200.0, 1e-9);
  EXPECT_EQ(observer.state()(0), 0.7);
}

TEST(Mdob, RefusesNonsense) {
  EXPECT_THROW(Mdob({0.0, 1.0, 1.0}, 1e-3), std::invalid_argument);
  EXPECT_THROW(Mdob({1.0, -1.0, 1.0}, 1e-3), std::invalid_argument);
  EXPECT_THROW(Mdob({1.0, 1.0, std::nan("")}, 1e-3), std::invalid_argument);
  EXPECT_THROW(Mdob({1.0, 1.0, 1.0}, 0.0), std::invalid_argument);
  EXPECT_THROW(Mdob({1.0, 1.0, INFINITY}, 1e-3), std::invalid_argument) << "estimates would be NaN";
}

}  // namespace
}  // namespace breakwater
