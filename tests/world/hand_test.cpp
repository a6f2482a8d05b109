#include <breakwater/world/hand.h>

#include <gtest/gtest.h>

namespace breakwater {
namespace {

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

}  // namespace
}  // namespace breakwater
