#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "world/encoder.h"
#include "world/low_pass.h"

namespace breakwater {
namespace {

TEST(Encoder, RoundsToTheNearestCount) {
  const Encoder encoder{0.1, 0.0};
  EXPECT_DOUBLE_EQ(encoder.measure(0.149), 0.1);
  EXPECT_DOUBLE_EQ(encoder.measure(0.151), 0.2);
  EXPECT_DOUBLE_EQ(encoder.measure(-0.149), -0.1);
  EXPECT_EQ(Encoder{}.measure(0.1234), 0.1234);
}

TEST(Encoder, ErrorIsWithinHalfACountAtAnyPhase) {
  for (const double phase : {0.0, 0.013, -0.04}) {
    const Encoder encoder{0.1, phase};
    for (double angle = -2.0; angle < 2.0; angle += 0.00317) {
      EXPECT_LE(std::abs(encoder.measure(angle) - angle), 0.05 + 1e-12);
      // All its values are whole counts apart.
      const double counts = (encoder.measure(angle) + phase) / 0.1;
      EXPECT_NEAR(counts, std::round(counts), 1e-9);
    }
  }
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

}  // namespace
}  // namespace breakwater
