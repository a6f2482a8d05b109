#include <breakwater/world/force_sensor.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr double kStep = 1e-4;

TEST(ForceSensor, WithoutLinksItPassesTheBitsOn) {
  Resonance body({}, kStep);
  body.reset(1.0);
  EXPECT_EQ(body.update(0.1), 0.1);
  EXPECT_FALSE(SensorElectronics{}.is_on());
  SampledReading reading({}, kStep, 1, "force");
  reading.reset(1.0);
  reading.update(0.1);
  EXPECT_EQ(reading.value(), 0.1);
}

TEST(ForceSensor, BodyAnswersAStepAsASecondOrderSystem) {
  const double omega = 300.0, zeta = 0.2;
  Resonance body({omega, zeta}, kStep);
  body.reset(0.0);
  const double damped = omega * std::sqrt(1.0 - zeta * zeta);
  for (int k = 1; k <= 1000; ++k) {
    const double t = k * kStep;
    const double expected =
        2.0 - 2.0 * std::exp(-zeta * omega * t) *
                  (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t));
    ASSERT_NEAR(body.update(2.0), expected, 1e-12) << k;
  }
}

double reading_of(const SensorElectronics& electronics, double value) {
  SampledReading reading(electronics, kStep, 1, "force");
  reading.reset(0.0);
  reading.update(value);
  return reading.value();
}

TEST(ForceSensor, BiasRangeAndStepsOfTheConverter) {
  EXPECT_DOUBLE_EQ(reading_of({.bias = 0.3}, 2.0), 2.3);
  EXPECT_DOUBLE_EQ(reading_of({.range = 1.5}, 2.0), 1.5);
  EXPECT_DOUBLE_EQ(reading_of({.range = 1.5}, -2.0), -1.5);
  EXPECT_DOUBLE_EQ(reading_of({.quantum = 0.25}, 1.9), 2.0);
  // The range is that of the biased value, and the converter comes last.
  EXPECT_DOUBLE_EQ(reading_of({.bias = 1.0, .range = 2.1, .quantum = 0.5}, 1.6), 2.0);
}

TEST(ForceSensor, HoldsForItsOwnPeriodAndDelays) {
  SampledReading reading({.period_s = 3 * kStep, .delay_s = 2 * kStep}, kStep, 1, "force");
  reading.reset(0.0);
  std::vector<double> seen;
  for (int k = 0; k < 9; ++k) {
    reading.update(k);
    seen.push_back(reading.value());
  }
  EXPECT_EQ(seen, (std::vector<double>{0, 0, 0, 0, 0, 3, 3, 3, 6}));
}

TEST(ForceSensor, DriftIsARandomWalkOfTheSizeThatWasAskedFor) {
  double square = 0.0;
  constexpr int kWalks = 400, kSteps = 100;
  for (int seed = 1; seed <= kWalks; ++seed) {
    SampledReading reading({.drift_per_sqrt_s = 0.5}, kStep, static_cast<std::uint64_t>(seed), "f");
    reading.reset(0.0);
    for (int k = 0; k <= kSteps; ++k) reading.update(0.0);
    square += reading.value() * reading.value();
  }
  // The variance of 400 walks has a standard deviation of 7 %.
  EXPECT_NEAR(square / kWalks, 0.25 * kSteps * kStep, 0.25 * 0.25 * kSteps * kStep);
}

TEST(ForceSensor, RefusesWhatIsNoSensor) {
  EXPECT_THROW(Resonance({-1.0, 0.1}, kStep), std::invalid_argument);
  EXPECT_THROW(Resonance({1.0, HUGE_VAL}, kStep), std::invalid_argument);
  const std::vector<SensorElectronics> wrong = {{.drift_per_sqrt_s = -1.0},
                                                {.range = -1.0},
                                                {.quantum = -1.0},
                                                {.period_s = 1.5 * kStep},
                                                {.delay_s = 0.5 * kStep}};
  for (const SensorElectronics& electronics : wrong) {
    EXPECT_THROW(SampledReading(electronics, kStep, 1, "f"), std::invalid_argument);
  }
}

}  // namespace
}  // namespace breakwater
