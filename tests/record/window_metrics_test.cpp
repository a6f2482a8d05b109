// Metrics of windows, and whether a reference is held.
#include <breakwater/record/held_reference.h>
#include <breakwater/record/window_metrics.h>
#include "support.h"

namespace breakwater::window_metrics_test {

TEST(WindowStatistics, AreThoseOfTheirDefinitions) {
  WindowStatistics statistics(TimeWindow{});
  EXPECT_FALSE(statistics.mean() || statistics.peak() || statistics.largest_deviation());
  for (const double value : {-3.0, -2.0, -1.0}) statistics.add(0.0, value);
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

TEST(ReachTime, CountsToTheFirstEntryOfThatSize) {
  ReachTime reach(1.0, 2.0), of_nothing(1.0, 0.0);
  for (const auto& [time_s, value] : {std::pair(2.0, 1.9), std::pair(3.0, -2.0)}) {
    EXPECT_FALSE(reach.value()) << time_s;
    reach.add(time_s, value);
    of_nothing.add(time_s, value);
  }
  reach.add(4.0, 5.0);
  EXPECT_EQ(reach.value(), 2.0);
  EXPECT_FALSE(of_nothing.value());
}

// The warning for a run of 8 s with a reference of 1 m or `asked`; "" if there is none.
std::string warning_of(const std::function<double(double)>& error, double asked = 1.0,
                       double end_s = 8.0, double large = INFINITY) {
  HeldReference held({0.0, 8.0}, "the position", "m");
  held.stay_within(large);
  if (asked != 0.0) held.ask(asked);
  for (int k = 0; k <= 1000.0 * end_s; ++k) held.add(1e-3 * k, error(1e-3 * k));
  std::vector<std::string> warnings;
  held.warn(warnings);
  return warnings.empty() ? "" : warnings.front();
}

TEST(HeldReference, IsHeldByAConvergingOutput) {
  for (const double asked : {0.0, 1.0}) {
    EXPECT_EQ(warning_of([](double t) { return std::exp(-t); }, asked), "");
    EXPECT_EQ(warning_of([](double t) { return std::exp(-0.1 * t) * std::cos(9 * t); }, asked), "");
    EXPECT_EQ(warning_of([](double) { return 0.0; }, asked), "");
    EXPECT_EQ(warning_of([](double) { return 0.3; }, asked), "") << "a part of it is missing";
  }
  EXPECT_EQ(warning_of([](double t) { return 0.01 * std::sin(20 * t); }), "");
}

TEST(HeldReference, ReportsAnErrorOfTheReferencesSize) {
  EXPECT_EQ(warning_of([](double) { return -0.9; }),
            "the position does not hold its reference: over the last 1 s its error is 0.9 m (rms), "
            "of 1 m to go");
  EXPECT_NE(warning_of([](double t) { return std::sin(40 * t); }), "") << "it swings";
  EXPECT_EQ(warning_of([](double) { return -0.9; }, 0.0), "") << "nothing was asked for";
  EXPECT_EQ(warning_of([](double) { return -0.9; }, 5.0), "") << "most of it is done";
}

TEST(HeldReference, ReportsTheSameForASmallStep) {
  for (const double scale : {1e-10, 1e-7, 1.0, 1e7}) {
    EXPECT_NE(warning_of([&](double) { return -0.9 * scale; }, scale), "") << scale;
    EXPECT_EQ(warning_of([&](double) { return 0.3 * scale; }, scale), "") << scale;
    EXPECT_TRUE(has(warning_of([&](double t) { return 1e-3 * scale * std::exp(0.6 * t); }, scale),
                    "grows to the end"))
        << scale;
  }
  EXPECT_EQ(warning_of([](double) { return 1e-16; }, 1e-16), "") << "rounding";
}

TEST(HeldReference, ReportsALargeErrorOfAHeldPose) {
  const auto falls = [](double t) { return std::min(t, 3.0); };
  EXPECT_EQ(warning_of(falls, 0.0, 8.0, 0.5),
            "the position does not hold its reference: over the last 1 s its error is 3 m (rms)");
  EXPECT_TRUE(has(warning_of(falls, 0.1, 8.0, 0.5), "is 3 m (rms), of 0.1 m to go"));
  EXPECT_EQ(warning_of([](double) { return 0.4; }, 0.0, 8.0, 0.5), "") << "it sags";
  EXPECT_EQ(warning_of([](double t) { return std::exp(-t); }, 0.0, 8.0, 0.5), "");
}

TEST(HeldReference, ReportsAGrowingError) {
  const auto grows = [](double t) { return 1e-3 * std::exp(0.6 * t) * std::cos(30 * t); };
  for (const double asked : {0.0, 1.0}) {
    EXPECT_TRUE(has(warning_of(grows, asked), "grows to the end"));
  }
  EXPECT_EQ(warning_of([](double t) { return 0.1 * t; }, 0.0), "") << "a ramp's lag";
  EXPECT_EQ(warning_of([](double t) { return t > 6.5 ? 0.4 : 0.0; }, 0.0), "") << "a late push";
  EXPECT_EQ(warning_of([](double t) { return 1e-16 * std::exp(2 * t); }, 0.0), "") << "rounding";
}

TEST(HeldReference, ReportsNothingForATimeOutsideTheRun) {
  EXPECT_EQ(warning_of([](double) { return 1.0; }, 1.0, 6.0), "");
}

}  // namespace breakwater::window_metrics_test
