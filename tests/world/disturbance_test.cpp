#include <breakwater/world/disturbance.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include <breakwater/world/delay_line.h>
#include <breakwater/world/pwm.h>

namespace breakwater {
namespace {

constexpr DisturbanceKind kKinds[] = {DisturbanceKind::none,      DisturbanceKind::step,
                                      DisturbanceKind::ramp,      DisturbanceKind::sine,
                                      DisturbanceKind::two_sines, DisturbanceKind::chirp};

// A disturbance from 1 s on, with the parameters of all kinds; the chirp goes from 2 to 5 rad/s in
// 2 s.
Disturbance of_kind(DisturbanceKind kind) {
  return {kind, 3.0, 2.0, 1.0, 0.7, 6.0, 5.0, 2.0};
}

TEST(Disturbance, IsNothingBeforeItsStart) {
  for (const auto kind : kKinds) EXPECT_EQ(of_kind(kind).value(0.999999), 0.0);
  EXPECT_EQ((Disturbance{DisturbanceKind::none, 3.0, 2.0, 1.0}.value(5.0)), 0.0);
}

TEST(Disturbance, AnOffsetActsAtAllTimes) {
  for (const auto kind : kKinds) {
    Disturbance with = of_kind(kind);
    with.offset = -0.4;
    EXPECT_EQ(with.value(0.5), -0.4);
    EXPECT_DOUBLE_EQ(with.value(1.3), of_kind(kind).value(1.3) - 0.4);
  }
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

TEST(Disturbance, IsNothingFromItsEndOn) {
  for (const auto kind : kKinds) {
    Disturbance pulse = of_kind(kind);
    const double before = pulse.value(1.9);
    pulse.end_s = 2.0;
    EXPECT_EQ(pulse.value(1.9), before);
    EXPECT_EQ(pulse.value(2.0), 0.0);
    EXPECT_EQ(pulse.rate(2.0), 0.0);
  }
}

// At a quarter of the first sine's period, the second sine (three times its frequency) is at −1.
TEST(Disturbance, TwoSinesAddUp) {
  const Disturbance two = of_kind(DisturbanceKind::two_sines);
  EXPECT_EQ(two.value(1.0), 0.0);
  EXPECT_NEAR(two.value(1.0 + M_PI / 4.0), 3.0 - 0.7, 1e-12);
  EXPECT_NEAR(two.rate(1.0), 3.0 * 2.0 + 0.7 * 6.0, 1e-12);
}

// The phase is the integral of the frequency, which grows linearly and then stays.
TEST(Disturbance, AChirpSweepsItsFrequencyAndKeepsTheLast) {
  const Disturbance chirp = of_kind(DisturbanceKind::chirp);
  const auto phase = [](double elapsed_s) {
    constexpr int kPieces = 3000;  // the midpoint rule is exact for a linear frequency
    double sum = 0.0;
    for (int i = 0; i < kPieces; ++i) {
      const double at = elapsed_s * (i + 0.5) / kPieces;
      sum += (at < 2.0 ? 2.0 + 1.5 * at : 5.0) * elapsed_s / kPieces;
    }
    return sum;
  };
  for (const double elapsed_s : {0.0, 0.5, 1.0, 2.0, 3.0, 6.0}) {
    EXPECT_NEAR(chirp.value(1.0 + elapsed_s), 3.0 * std::sin(phase(elapsed_s)), 1e-9) << elapsed_s;
  }
  // It may also slow down.
  const Disturbance slower{DisturbanceKind::chirp, 1.0, 5.0, 0.0, 0.0, 0.0, 0.0, 2.0};
  EXPECT_DOUBLE_EQ(slower.value(2.0), std::sin(5.0));
  EXPECT_DOUBLE_EQ(slower.value(9.0), std::sin(5.0));
  EXPECT_EQ(slower.rate(9.0), 0.0);
}

TEST(Disturbance, ItsRateIsTheSlopeOfItsValue) {
  constexpr double kStep_s = 1e-5;
  for (const auto kind : kKinds) {
    const Disturbance disturbance = of_kind(kind);
    for (const double t : {0.5, 1.1, 2.0, 3.7}) {
      const double slope =
          (disturbance.value(t + kStep_s) - disturbance.value(t - kStep_s)) / (2.0 * kStep_s);
      EXPECT_NEAR(disturbance.rate(t), slope, 2e-8) << t;
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

TEST(DelayLine, DelaysItsInputByAFixedNumberOfCalls) {
  for (int delay = 0; delay < 4; ++delay) {
    DelayLine line(delay);
    for (int k = 0; k < 20; ++k) EXPECT_EQ(line.update(k), std::max(k - delay, 0)) << delay;
  }
  EXPECT_THROW(DelayLine(-1), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
