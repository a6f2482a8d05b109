#include <breakwater/record/window_metrics.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace breakwater {
namespace {

TEST(WindowStatistics, CountsSamplesInItsWindowBothEndsIncluded) {
  WindowStatistics statistics({1.0, 3.0});
  for (int t = 0; t <= 4; ++t) statistics.add(t, t == 0 || t == 4 ? 100.0 : t - 4.0);  // −3 −2 −1
  EXPECT_DOUBLE_EQ(*statistics.mean(), -2.0);
  EXPECT_DOUBLE_EQ(*statistics.rms(), std::sqrt(14.0 / 3.0));
  EXPECT_EQ(*statistics.largest(), -1.0);
  EXPECT_EQ(*statistics.smallest(), -3.0);
  EXPECT_EQ(*statistics.peak(), 3.0);
  EXPECT_DOUBLE_EQ(*statistics.standard_deviation(), 1.0);
  EXPECT_DOUBLE_EQ(*statistics.largest_deviation(), 1.0);
}

TEST(WindowStatistics, TheSpreadDoesNotSufferFromALargeMean) {
  WindowStatistics statistics(TimeWindow{});
  for (int t = 0; t < 1000; ++t) statistics.add(t, 1e8 + (t % 2 == 0 ? 0.5 : -0.5));
  EXPECT_NEAR(*statistics.standard_deviation(), 0.5 * std::sqrt(1000.0 / 999.0), 1e-6);
}

TEST(ReversalCount, CountsReversalsLargerThanTheBand) {
  const auto turns = [](const std::vector<double>& values) {
    ReversalCount count(0.1);
    for (const double value : values) count.add(value);
    return count.value();
  };
  EXPECT_EQ(turns({}), 0);
  EXPECT_EQ(turns({0.0, 0.05, -0.04, 0.05}), 0) << "within the band";
  EXPECT_EQ(turns({0.0, 0.5, 1.0}), 0) << "the first way";
  EXPECT_EQ(turns({0.0, 1.0, 0.95, 1.0, 0.91}), 0);
  EXPECT_EQ(turns({0.0, 1.0, 0.95, 0.89}), 1) << "by small steps";
  EXPECT_EQ(turns({0.0, -1.0, 0.0, -1.0, 0.0}), 3);
}

TEST(ReversalCount, ForADampedCosineStopsWithinTheBand) {
  ReversalCount count(0.1);
  // Each swing is e^(−0.2 π) times the one before: 1.54 (does not count), 0.83, 0.45, 0.24, 0.13,
  // 0.07.
  for (int i = 0; i < 10000; ++i) count.add(std::exp(-0.002 * i) * std::cos(0.01 * i));
  EXPECT_EQ(count.value(), 4);
}

TEST(WindowStatistics, WithoutSamplesAreEmpty) {
  WindowStatistics statistics({1.0, 3.0});
  statistics.add(0.5, 1.0);
  EXPECT_FALSE(statistics.mean());
  EXPECT_FALSE(statistics.rms());
  EXPECT_FALSE(statistics.peak());
  EXPECT_FALSE(statistics.standard_deviation());
  EXPECT_FALSE(statistics.largest_deviation());
}

TEST(TimeWindow, CountsOnlyAWindowThatTheRunCovers) {
  const TimeWindow window{1.0, 3.0};
  EXPECT_TRUE(window.within(3.0).contains(1.0));
  EXPECT_TRUE(window.within(3.0).contains(3.0));
  WindowStatistics cut(window.within(2.9));
  for (int t = 0; t <= 4; ++t) cut.add(t, 1.0);
  EXPECT_FALSE(cut.mean());
  EXPECT_FALSE(cut.peak());
  EXPECT_FALSE((TimeWindow{-0.5, 3.0}.within(4.0).contains(1.0))) << "begins before the run";
  EXPECT_TRUE(TimeWindow{}.within(0.1).contains(0.1)) << "all of a run, however short";
  EXPECT_TRUE(TimeWindow{2.0}.within(1.0).contains(2.0)) << "an open end is the run's";
}

TEST(SettlingTime, CountsFromTheStartToTheLastEntryIntoTheBand) {
  SettlingTime settling(TimeWindow{1.0, 7.0}, 0.5);
  const double errors[] = {9.0, 9.0, 0.4, 0.6, 0.5, -0.1, 0.0};  // at 0 … 6 s
  for (int t = 0; t < 7; ++t) settling.add(t, errors[t]);
  EXPECT_EQ(*settling.value(), 3.0);  // in the band from 4 s
  settling.add(7.0, 0.7);
  EXPECT_FALSE(settling.value());  // outside the band again
  settling.add(7.5, 0.0);
  EXPECT_FALSE(settling.value());  // later samples do not count
}

TEST(ReachTime, CountsToTheFirstEntryOfThatSize) {
  ReachTime reach(1.0, 2.0), of_nothing(1.0, 0.0);
  for (const auto& [time_s, value] :
       {std::pair(0.5, 3.0), std::pair(2.0, 1.9), std::pair(3.0, -2.0)}) {
    EXPECT_FALSE(reach.value()) << time_s;
    reach.add(time_s, value);
    of_nothing.add(time_s, value);
  }
  reach.add(4.0, 5.0);
  EXPECT_EQ(reach.value(), 2.0);
  EXPECT_FALSE(of_nothing.value());
}

TEST(SettlingTime, IsEmptyIfTheRunIsTooShort) {
  SettlingTime settling(TimeWindow{0.0, 7.0}.within(3.0), 0.5);
  for (int t = 0; t <= 3; ++t) settling.add(t, 0.0);
  EXPECT_FALSE(settling.value());
}

TEST(SettlingTime, UsesALongerRunToItsEnd) {
  SettlingTime settling(TimeWindow{1.0, 3.0}.within_and_on(7.0), 0.5);
  for (int t = 0; t <= 7; ++t) settling.add(t, t < 6 ? 9.0 : 0.0);
  EXPECT_EQ(*settling.value(), 5.0);
  SettlingTime brief(TimeWindow{1.0, 3.0}.within_and_on(2.0), 0.5);
  for (int t = 0; t <= 2; ++t) brief.add(t, 0.0);
  EXPECT_FALSE(brief.value());
}

TEST(SettlingTime, IsEmptyWithoutSamples) {
  EXPECT_FALSE(SettlingTime(TimeWindow{1.0}, 0.5).value());
}

}  // namespace
}  // namespace breakwater
