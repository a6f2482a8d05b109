// Mills' ratio against the C library's erfc in extended precision.
#include <breakwater/math/mills_ratio.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace breakwater::mills_ratio_test {
namespace {

TEST(MillsRatio, MatchesTheNormalTail) {
  for (double x = 0.0; x < 100.0; x += x < 8.0 ? 1.0 / 128.0 : 0.25) {
    const long double z = x;
    const long double truth = std::erfc(z / std::sqrt(2.0L)) * std::exp(z * z / 2.0L) *
                              std::sqrt(std::acos(-1.0L) / 2.0L);
    EXPECT_NEAR(math::mills_ratio(x) / static_cast<double>(truth), 1.0, 2e-15) << x;
  }
}

// 1/x − 1/x³ < (1 − Φ)/φ < 1/x, where erfc underflows.
TEST(MillsRatio, FollowsItsBoundsWhereTheTailUnderflows) {
  for (const double x : {1e3, 1e6, 1e150, 1e300}) {
    EXPECT_LE(math::mills_ratio(x), (1.0 + 1e-15) / x);
    EXPECT_GE(math::mills_ratio(x), (1.0 - 1e-15) * (1.0 - 1.0 / x / x) / x);
  }
  EXPECT_EQ(math::mills_ratio(std::numeric_limits<double>::infinity()), 0.0);
}

}  // namespace
}  // namespace breakwater::mills_ratio_test
