// The data of a replay's page: its times.
#include <breakwater/pictures/replay_data.h>

#include "support.h"

namespace breakwater::replay_motion_test {

std::vector<double> log_times(double end_s, double step_s) {
  std::vector<double> times;
  for (int i = 0; i <= std::lround(end_s / step_s); ++i) times.push_back(i * step_s);
  return times;
}

TEST(ReplayTimes, AreThirtyPerSecondAlsoInSlowMotion) {
  const std::vector<double> times = replay_times(log_times(100.0, 0.001), {29.9, 31.5, 0.1});
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_NEAR(times.back(), 100.0, 1e-9);
  double inside = 0.0;
  double outside = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    ASSERT_GT(times[i], times[i - 1]);
    double& largest = times[i] > 29.9 && times[i] < 31.5 ? inside : outside;
    largest = std::max(largest, times[i] - times[i - 1]);
  }
  EXPECT_NEAR(outside, 1.0 / 30.0, 1e-4);
  EXPECT_NEAR(inside, 0.1 / 30.0, 1e-5);
}

TEST(ReplayTimes, AreLimitedByTheLogAndThePage) {
  const auto coarse = replay_times(log_times(10.0, 0.1), {2.0, 4.0, 0.01});
  EXPECT_EQ(coarse.size(), 101U);
  const auto many = replay_times(log_times(1e5, 0.5), {0.0, 1e5, 1.0});
  EXPECT_LE(many.size(), 40001U);
  EXPECT_NEAR(many.back(), 1e5, 1e-6);
}

}  // namespace breakwater::replay_motion_test
