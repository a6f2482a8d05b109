#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <breakwater/world/encoder.h>
#include <breakwater/world/low_pass.h>
#include <breakwater/world/sensor_fault.h>

namespace breakwater {
namespace {

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
  EXPECT_THROW(LowPass(-1.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(LowPass(1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(LowPass(std::nan(""), 1e-3), std::invalid_argument);
}

TEST(FaultySensor, BreaksFromItsTimeForItsSamples) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Row {
    FaultKind kind;
    double size;
    int delay_samples;
    std::vector<double> readings;  // readings of 0, 1.1, 2.2, 3.3, 4.4, 5.5, 6.6
  };
  const std::vector<Row> rows = {
      {FaultKind::nan, 0.0, 1, {0.0, 1.1, kNan, kNan, kNan, 5.5, 6.6}},
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
  EXPECT_THROW(FaultySensor({"q", 0.0, 1, FaultKind::stuck}, 1e-3), std::invalid_argument);
  EXPECT_THROW(FaultySensor({"q", 0.0, 1, FaultKind::bias, kNan}, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
