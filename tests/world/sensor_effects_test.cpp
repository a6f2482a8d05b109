// Effects of a sensor on the motion that it measures, and the hand that moves a link.
#include <breakwater/world/encoder.h>
#include <breakwater/world/force_sensor.h>
#include <breakwater/world/hand.h>
#include <breakwater/world/low_pass.h>
#include <breakwater/world/noise.h>
#include <breakwater/world/sensor_fault.h>
#include "support.h"

namespace breakwater::sensor_effects_test {

TEST(Encoder, RoundsToTheNearestCount) {
  const Encoder encoder{0.1, 0.0};
  EXPECT_DOUBLE_EQ(encoder.measure(0.149), 0.1);
  EXPECT_DOUBLE_EQ(encoder.measure(0.151), 0.2);
  EXPECT_DOUBLE_EQ(encoder.measure(-0.149), -0.1);
  EXPECT_EQ(Encoder{}.measure(0.1234), 0.1234);
}

TEST(Encoder, TruncatesTowardsZeroOnBothSides) {
  for (const EncoderOrigin origin : {EncoderOrigin::counted, EncoderOrigin::calibrated}) {
    const Encoder encoder{0.1, 0.0, origin, EncoderRounding::truncate};
    for (const double sign : {1.0, -1.0}) {
      EXPECT_EQ(encoder.measure(sign * 0.0999), 0.0);
      EXPECT_DOUBLE_EQ(encoder.measure(sign * 0.1001), sign * 0.1);
      EXPECT_DOUBLE_EQ(encoder.measure(sign * 0.1999), sign * 0.1);
    }
  }
  // The phase moves the edges here too, but the encoder still reads 0 at its start.
  const Encoder late{0.1, 0.03, EncoderOrigin::counted, EncoderRounding::truncate};
  EXPECT_EQ(late.measure(0.0699), 0.0);
  EXPECT_DOUBLE_EQ(late.measure(0.0701), 0.1);
  EXPECT_EQ(late.measure(-0.1299), 0.0);
  EXPECT_DOUBLE_EQ(late.measure(-0.1301), -0.1);
}

TEST(Encoder, CountsFromWhereItStarts) {
  for (const double phase : {0.0, 0.013, -0.04, 0.37}) {
    const Encoder encoder{0.1, phase};
    EXPECT_EQ(encoder.measure(0.0), 0.0);
    for (double angle = -2.0; angle < 2.0; angle += 0.00317) {
      const double counts = encoder.measure(angle) / 0.1;
      EXPECT_NEAR(counts, std::round(counts), 1e-9);  // whole counts
      // Half a count of rounding, plus the start position between two edges.
      const double start = phase - 0.1 * std::round(phase / 0.1);
      EXPECT_LE(std::abs(encoder.measure(angle) - angle - start), 0.05 + 1e-12);
    }
  }
  // The phase moves the edges: the first upper one is at Δ/2 − φ.
  const Encoder early{0.1, 0.03};
  EXPECT_EQ(early.measure(0.0199), 0.0);
  EXPECT_DOUBLE_EQ(early.measure(0.0201), 0.1);
}

TEST(Encoder, WithCalibrationTheErrorIsHalfACountAtAnyPhase) {
  for (const double phase : {0.0, 0.013, -0.04}) {
    const Encoder encoder{0.1, phase, EncoderOrigin::calibrated};
    for (double angle = -2.0; angle < 2.0; angle += 0.00317) {
      EXPECT_LE(std::abs(encoder.measure(angle) - angle), 0.05 + 1e-12);
      const double counts = (encoder.measure(angle) + phase) / 0.1;
      EXPECT_NEAR(counts, std::round(counts), 1e-9);
    }
  }
}

TEST(Encoder, CountsPerRevolutionFollowEquation423) {
  const EncoderCounts counts{8, 4, 50};
  EXPECT_EQ(counts.counts_per_revolution(), 256 * 4 * 50);
  EXPECT_DOUBLE_EQ(counts.quantum_rad(), 2 * M_PI / (256 * 4 * 50));
  EXPECT_DOUBLE_EQ((EncoderCounts{8}.quantum_rad()), 0.02454369260617026);  // the thesis' 0.0245
}

TEST(LowPass, StepResponseHasItsClosedForm) {
  const double tau = 0.05, T = 1e-4;
  LowPass filter(tau, T);
  filter.reset(0.0);
  for (int k = 1; k <= 2000; ++k) {
    EXPECT_NEAR(filter.update(3.0), 3.0 * -std::expm1(-k * T / tau), 1e-12);
  }
}

TEST(LowPass, WithoutTimeConstantItPassesItsInputOn) {
  LowPass filter(0.0, 1e-3);
  EXPECT_EQ(filter.update(4.2), 4.2);
}

TEST(LowPass, RefusesNonsense) {
  EXPECT_REFUSED(LowPass(-1.0, 1e-3));
  EXPECT_REFUSED(LowPass(1.0, 0.0));
  EXPECT_REFUSED(LowPass(std::nan(""), 1e-3));
}

TEST(FaultySensor, BreaksFromItsTimeForItsSamples) {
  struct Row {
    FaultKind kind;
    double size;
    int delay_samples;
    std::vector<double> readings;  // readings of 0, 1.1, 2.2, 3.3, 4.4, 5.5, 6.6
  };
  const std::vector<Row> rows = {
      {FaultKind::nan, 0.0, 1, {0.0, 1.1, kNaN, kNaN, kNaN, 5.5, 6.6}},
      {FaultKind::infinity, 0.0, 1, {0.0, 1.1, kInfinity, kInfinity, kInfinity, 5.5, 6.6}},
      {FaultKind::frozen, 0.0, 1, {0.0, 1.1, 1.1, 1.1, 1.1, 5.5, 6.6}},
      {FaultKind::dropped, 0.0, 1, {0.0, 1.1, 1.1, 1.1, 1.1, 1.1, 6.6}},  // 4 times 12.5 ms
      {FaultKind::spike, 7.0, 1, {0.0, 1.1, 9.2, -3.7, 11.4, 5.5, 6.6}},
      {FaultKind::bias, -7.0, 1, {0.0, 1.1, -4.8, -3.7, -2.6, 5.5, 6.6}},
      {FaultKind::delay, 0.0, 1, {0.0, 1.1, 1.1, 2.2, 3.3, 5.5, 6.6}},
      {FaultKind::delay, 0.0, 4, {0.0, 1.1, 0.0, 0.0, 0.0, 5.5, 6.6}},
      {FaultKind::stuck, 2.0, 1, {0.0, 1.1, 2.0, 2.0, 4.0, 5.5, 6.6}}};
  for (const Row& row : rows) {
    constexpr double kPeriod_s = 0.0125;
    FaultySensor sensor({"q", 2 * kPeriod_s, 3, row.kind, row.size, row.delay_samples}, 1e-3);
    for (std::size_t k = 0; k < row.readings.size(); ++k) {
      const double time = static_cast<double>(k);
      const double reading = sensor.update(kPeriod_s * time, 1.1 * time);
      const double expected = row.readings[k];
      const bool is_same = std::isnan(expected)   ? std::isnan(reading)
                           : std::isinf(expected) ? reading == expected
                                                  : std::abs(reading - expected) < 1e-12;
      EXPECT_TRUE(is_same) << static_cast<int>(row.kind) << ", " << k << ": " << reading;
    }
  }
  FaultySensor at_once({"q", 0.0, 2, FaultKind::frozen}, 1e-3);
  EXPECT_EQ(at_once.update(0.0, 3.0), 3.0);
  EXPECT_EQ(at_once.update(1.0, 4.0), 3.0);
  EXPECT_REFUSED(FaultySensor({"q", 0.0, 1, FaultKind::stuck}, 1e-3));
  EXPECT_REFUSED(FaultySensor({"q", 0.0, 1, FaultKind::bias, kNaN}, 1e-3));
}

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
  EXPECT_REFUSED(Resonance({-1.0, 0.1}, kStep));
  EXPECT_REFUSED(Resonance({1.0, HUGE_VAL}, kStep));
  const std::vector<SensorElectronics> wrong = {{.drift_per_sqrt_s = -1.0},
                                                {.range = -1.0},
                                                {.quantum = -1.0},
                                                {.period_s = 1.5 * kStep},
                                                {.delay_s = 0.5 * kStep}};
  for (const SensorElectronics& electronics : wrong) {
    EXPECT_REFUSED(SampledReading(electronics, kStep, 1, "f"));
  }
}

TEST(Noise, IsAPureFunctionOfSeedChannelAndSample) {
  const Noise a(7, "q1"), b(7, "q1");
  const double later = a(1000);
  a(3);
  EXPECT_EQ(b(1000), later);
  EXPECT_NE(Noise(8, "q1")(1000), later);
  EXPECT_NE(Noise(7, "q2")(1000), later);
  EXPECT_NE(a(1001), later);
}

TEST(Noise, IsStandardNormal) {
  const Noise noise(1, "force");
  const int n = 200000;
  std::vector<double> values;
  double sum = 0, squares = 0;
  for (int k = 0; k < n; ++k) {
    values.push_back(noise(static_cast<std::uint64_t>(k)));
    sum += values.back();
    squares += values.back() * values.back();
  }
  EXPECT_NEAR(sum / n, 0.0, 4 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1.0, 4 * std::sqrt(2.0 / n));
  // Kolmogorov–Smirnov against the normal distribution, at 0.1 %.
  std::sort(values.begin(), values.end());
  double largest = 0;
  for (int k = 0; k < n; ++k) {
    const double normal = 0.5 * std::erfc(-values[k] / std::sqrt(2.0));
    largest = std::max({largest, std::abs(normal - static_cast<double>(k) / n),
                        std::abs(normal - static_cast<double>(k + 1) / n)});
  }
  EXPECT_LT(largest, 1.95 / std::sqrt(n));
}

TEST(Noise, SamplesAndChannelsAreUncorrelated) {
  const Noise a(1, "q1"), b(1, "q2");
  const int n = 100000;
  double neighbours = 0, channels = 0;
  for (std::uint64_t k = 0; k < n; ++k) {
    neighbours += a(k) * a(k + 1);
    channels += a(k) * b(k);
  }
  EXPECT_NEAR(neighbours / n, 0.0, 4 / std::sqrt(n));
  EXPECT_NEAR(channels / n, 0.0, 4 / std::sqrt(n));
}

constexpr Hand kHand{3.0, 1.5, 0.5, 1.2, 2000.0, 60.0};

TEST(Hand, TurnsSmoothlyAndLetsGo) {
  EXPECT_EQ(kHand.target_rad(2.0), 0.0);
  EXPECT_EQ(kHand.target_rad(3.0), 0.0);
  EXPECT_DOUBLE_EQ(kHand.target_rad(3.75), 0.6);
  EXPECT_DOUBLE_EQ(kHand.target_rad(4.5), 1.2);
  EXPECT_DOUBLE_EQ(kHand.target_rad(4.9), 1.2);
  EXPECT_FALSE(kHand.grips(2.999));
  EXPECT_TRUE(kHand.grips(3.0));
  EXPECT_TRUE(kHand.grips(4.999));
  EXPECT_FALSE(kHand.grips(5.0));
  EXPECT_EQ(kHand.moment_Nm(5.0, 0.7, 0.0), 0.0);
}

TEST(Hand, PullsTowardsItsPosition) {
  // The hand has no effect on a link with its position and velocity.
  const double t = 3.4, dt = 1e-6;
  const double rate = (kHand.target_rad(t + dt) - kHand.target_rad(t - dt)) / (2 * dt);
  EXPECT_NEAR(kHand.moment_Nm(t, kHand.target_rad(t), rate), 0.0, 1e-6);
  EXPECT_NEAR(kHand.moment_Nm(t, kHand.target_rad(t) - 0.01, rate), 20.0, 1e-6);
  EXPECT_NEAR(kHand.moment_Nm(t, kHand.target_rad(t), rate + 0.1), -6.0, 1e-6);
}

TEST(Hand, PushesWithAGivenMoment) {
  Hand hand = kHand;
  hand.given_moment_Nm = 8.0;
  EXPECT_EQ(hand.moment_Nm(2.9, 0.0, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(hand.moment_Nm(3.75, 0.0, 0.0), 4.0);
  EXPECT_DOUBLE_EQ(hand.moment_Nm(4.9, 2.0, -3.0), 8.0);  // wherever the link is
  EXPECT_EQ(hand.moment_Nm(5.0, 0.0, 0.0), 0.0);
}

}  // namespace breakwater::sensor_effects_test
