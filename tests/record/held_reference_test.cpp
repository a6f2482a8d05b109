// Whether a reference is held.
#include <breakwater/record/held_reference.h>
#include "support.h"

namespace breakwater::held_reference_test {

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

}  // namespace breakwater::held_reference_test
