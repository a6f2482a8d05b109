#include <breakwater/world/disturbance.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include <breakwater/world/delay_line.h>
#include <breakwater/world/pwm.h>

namespace breakwater {
namespace {

TEST(Disturbance, IsNothingBeforeItsStart) {
  for (const auto kind : {DisturbanceKind::none, DisturbanceKind::step, DisturbanceKind::ramp,
                          DisturbanceKind::sine}) {
    EXPECT_EQ((Disturbance{kind, 3.0, 2.0, 1.0}.value(0.999999)), 0.0);
  }
  EXPECT_EQ((Disturbance{DisturbanceKind::none, 3.0, 2.0, 1.0}.value(5.0)), 0.0);
}

TEST(Disturbance, HasItsShapeFromThenOn) {
  const Disturbance step{DisturbanceKind::step, 3.0, 0.0, 1.0};
  EXPECT_EQ(step.value(1.0), 3.0);  // at the start, exactly
  EXPECT_EQ(step.value(100.0), 3.0);
  const Disturbance ramp{DisturbanceKind::ramp, 0.5, 0.0, 1.0};
  EXPECT_EQ(ramp.value(1.0), 0.0);
  EXPECT_DOUBLE_EQ(ramp.value(5.0), 2.0);
  const Disturbance sine{DisturbanceKind::sine, 2.0, 10.0, 1.0};
  EXPECT_DOUBLE_EQ(sine.value(1.0 + M_PI / 20.0), 2.0);
  EXPECT_NEAR(sine.value(1.0 + M_PI / 10.0), 0.0, 1e-12);
}

TEST(Disturbance, ItsRateIsTheSlopeOfItsValue) {
  constexpr double kStep_s = 1e-5;
  for (const auto kind : {DisturbanceKind::none, DisturbanceKind::step, DisturbanceKind::ramp,
                          DisturbanceKind::sine}) {
    const Disturbance disturbance{kind, 3.0, 2.0, 1.0};
    for (const double t : {0.5, 1.1, 2.0, 3.7}) {
      const double slope =
          (disturbance.value(t + kStep_s) - disturbance.value(t - kStep_s)) / (2.0 * kStep_s);
      EXPECT_NEAR(disturbance.rate(t), slope, 1e-8) << t;
    }
  }
}

TEST(Pwm, RoundsToItsSteps) {
  const Pwm pwm{0.25};
  EXPECT_EQ(pwm.output(0.6), 0.5);
  EXPECT_EQ(pwm.output(-0.7), -0.75);
  EXPECT_EQ(pwm.output(0.1), 0.0);  // a dead zone of half a step
  EXPECT_EQ(Pwm{}.output(0.123), 0.123);
}

TEST(DelayLine, GivesWhatItWasGivenSoManyCallsAgo) {
  for (int delay = 0; delay < 4; ++delay) {
    DelayLine line(delay);
    for (int k = 0; k < 20; ++k) EXPECT_EQ(line.update(k), std::max(k - delay, 0)) << delay;
  }
  EXPECT_THROW(DelayLine(-1), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
