#include <breakwater/world/noise.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace breakwater {
namespace {

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

}  // namespace
}  // namespace breakwater
