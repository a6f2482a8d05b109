// The motor without an engine, for tests of estimators.
#include "observers/motor_loop.h"

#include <gtest/gtest.h>

namespace breakwater::motor_loop_test {
namespace {

// Starts at 3 rad/s with only 2 N m of dry friction on 0.5 kg m²: a = −4 until rest.
TEST(MotorLoop, DryFrictionStopsTheShaftAndHoldsIt) {
  double q = 0.0, v = 3.0;
  for (int i = 0; i < 100; ++i) testing::slide(q, v, 0.0, 2.0, 0.5, 0.01);
  EXPECT_NEAR(q, 3.0 * 3.0 / (2.0 * 4.0), 1e-12);
  EXPECT_EQ(v, 0.0);
  const double at_rest = q;
  testing::slide(q, v, -1.99, 2.0, 0.5, 0.01);
  EXPECT_EQ(q, at_rest);
  testing::slide(q, v, -3.0, 2.0, 0.5, 0.01);  // breaks away with the remaining 1 N m
  EXPECT_DOUBLE_EQ(v, -1.0 / 0.5 * 0.01);
}

// A torque against the motion: the shaft stops and turns back within one step.
TEST(MotorLoop, DryFrictionTurnsWithTheShaft) {
  double q = 0.0, v = 1.0;
  testing::slide(q, v, -3.0, 1.0, 1.0, 0.5);  // a = −4 for ¼ s, then −2
  EXPECT_DOUBLE_EQ(v, -0.5);
  EXPECT_DOUBLE_EQ(q, 0.125 - 0.0625);
}

}  // namespace
}  // namespace breakwater::motor_loop_test
