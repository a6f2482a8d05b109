#include <breakwater/plants/damped_inertia.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace breakwater {
namespace {

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
  EXPECT_THROW(damped_inertia(0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(damped_inertia(1.0, -1.0), std::invalid_argument);
  EXPECT_THROW(damped_inertia(std::nan(""), 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
