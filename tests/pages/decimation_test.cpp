#include <breakwater/pages/page_chart.h>

#include "support.h"

namespace breakwater::decimation_test {

Series impact() {
  Series series;
  for (int i = 0; i < 100000; ++i) {
    const double t = 1e-3 * i;
    series.times_s.push_back(t);
    series.values.push_back(std::sin(t) * 1e-3);
  }
  series.values[30527] = 7.93;  // a peak of one sample
  series.values[61234] = -5.5;
  return series;
}

TEST(Decimation, KeepsEveryPeakAtItsTime) {
  const Series series = impact();
  const Series thin = decimate(series, 300);
  EXPECT_LE(thin.values.size(), 2U * 300U + 2U);
  const auto largest = std::max_element(thin.values.begin(), thin.values.end());
  EXPECT_EQ(*largest, 7.93);
  EXPECT_EQ(thin.times_s[static_cast<std::size_t>(largest - thin.values.begin())], 1e-3 * 30527);
  EXPECT_EQ(*std::min_element(thin.values.begin(), thin.values.end()), -5.5);
  EXPECT_EQ(thin.times_s.front(), series.times_s.front());
  EXPECT_EQ(thin.times_s.back(), series.times_s.back());
}

TEST(Decimation, APeakBesideNanStays) {
  Series series = impact();
  series.values[30520] = std::numeric_limits<double>::quiet_NaN();
  series.values[30400] = std::numeric_limits<double>::quiet_NaN();
  double largest = 0.0;
  for (const double value : decimate(series, 300).values) {
    if (value > largest) largest = value;
  }
  EXPECT_EQ(largest, 7.93);
}

TEST(Decimation, KeepsTheExtremesOfAnyPart) {
  testing::Random random(7);
  Series series;
  for (int i = 0; i < 9973; ++i) {
    series.times_s.push_back(0.01 * i);
    series.values.push_back(random.uniform(-1.0, 1.0));
  }
  const Series thin = decimate(series, 100);
  EXPECT_TRUE(std::is_sorted(thin.times_s.begin(), thin.times_s.end()));
  for (std::size_t bucket = 0; bucket < 100; ++bucket) {
    const std::size_t begin = bucket * 9973 / 100;
    const std::size_t end = (bucket + 1) * 9973 / 100;
    const Series before = cut(series, series.times_s[begin], series.times_s[end - 1]);
    const Series after = cut(thin, series.times_s[begin], series.times_s[end - 1]);
    EXPECT_EQ(*std::max_element(before.values.begin(), before.values.end()),
              *std::max_element(after.values.begin(), after.values.end()));
    EXPECT_EQ(*std::min_element(before.values.begin(), before.values.end()),
              *std::min_element(after.values.begin(), after.values.end()));
  }
}

TEST(Decimation, AStepStaysAStep) {
  Series series;
  for (int i = 0; i < 10000; ++i) {
    series.times_s.push_back(i);
    series.values.push_back(i < 5000 ? 0.0 : 1.0);
  }
  const Series thin = decimate(series, 100);
  EXPECT_LE(thin.values.size(), 6U);
  EXPECT_EQ(thin.at(4800.0).value, 0.0);
  EXPECT_EQ(thin.at(5200.0).value, 1.0);
}

TEST(Decimation, ShortSeriesDoNotChange) {
  const Series series{{0.0, 1.0, 2.0}, {3.0, 1.0, 2.0}};
  EXPECT_EQ(decimate(series, 10).values, series.values);
  EXPECT_TRUE(decimate(Series{}, 10).values.empty());
}

}  // namespace breakwater::decimation_test
