#include <breakwater/render/chart.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace breakwater::chart_test {
namespace {

constexpr int kWidth = 460;
constexpr int kHeight = 220;

ChartLine ramp() {
  return {"ramp", {{0.0, 1.0, 2.0}, {0.0, 5.0, 10.0}}};
}

// The middle of the dot in the first line's colour.
Point dot_of(Canvas& canvas) {
  const Colour c = on_paper(0);
  const auto is_colour = [&](int x, int y) {
    const std::uint8_t* p = canvas.pixels() + 4 * (y * canvas.width() + x);
    return std::abs(p[0] - 255.0 * c.blue) < 2 && std::abs(p[1] - 255.0 * c.green) < 2 &&
           std::abs(p[2] - 255.0 * c.red) < 2;
  };
  // The dot is 9 px wide, the line 2 px. Only the dot contains a 5×5 square of the colour.
  double x_sum = 0.0;
  double y_sum = 0.0;
  int count = 0;
  for (int y = 2; y + 2 < canvas.height(); ++y) {
    for (int x = 2; x + 2 < canvas.width(); ++x) {
      bool all = true;
      for (int k = 0; k < 25 && all; ++k) all = is_colour(x + k % 5 - 2, y + k / 5 - 2);
      if (!all) continue;
      x_sum += x + 0.5;
      y_sum += y + 0.5;
      ++count;
    }
  }
  EXPECT_GT(count, 0) << "there is no dot";
  return {x_sum / count, y_sum / count};
}

TEST(Chart, TheDotIsAtTheEndOfTheLine) {
  Chart chart("t", {ramp()}, {0.0, 2.0, 0.0, 10.0}, kWidth, kHeight, 1.0);
  // The frame gives the positions of (0 s, 0) and (2 s, 10). The dot moves straight between them.
  const Point origin = chart.place(0.0, 0.0);
  const Point end = chart.place(2.0, 10.0);
  EXPECT_GT(end.x - origin.x, 0.7 * kWidth);
  EXPECT_GT(origin.y - end.y, 0.5 * kHeight);
  for (const double t : {0.3, 0.9, 1.7}) {
    Canvas canvas(kWidth, kHeight);
    chart.draw(canvas, 0, 0, t);
    const Point dot = dot_of(canvas);
    EXPECT_NEAR(dot.x, origin.x + 0.5 * t * (end.x - origin.x), 1.0) << t;
    EXPECT_NEAR(dot.y, origin.y + 0.5 * t * (end.y - origin.y), 1.0) << t;
  }
}

TEST(Chart, DrawsNoFutureValues) {
  Chart chart("t", {ramp()}, {0.0, 2.0, 0.0, 10.0}, kWidth, kHeight, 1.0);
  Canvas early(kWidth, kHeight);
  chart.draw(early, 0, 0, 1.0);
  Canvas empty(kWidth, kHeight);
  chart.draw(empty, 0, 0, 0.0);
  const int from = static_cast<int>(chart.place(1.0, 0.0).x) + 8;
  for (int y = 0; y < kHeight; ++y) {
    for (int i = 4 * (y * kWidth + from); i < 4 * (y + 1) * kWidth; ++i) {
      ASSERT_EQ(early.pixels()[i], empty.pixels()[i]);
    }
  }
}

TEST(Chart, DrawsAPeakNarrowerThanAPixel) {
  ChartLine spike{"spike", {}};
  for (int i = 0; i <= 100000; ++i) {
    spike.series.times_s.push_back(2.0 * i / 100000.0);
    spike.series.values.push_back(i == 50000 ? 10.0 : 0.0);
  }
  Chart chart("t", {spike}, {0.0, 2.0, 0.0, 10.0}, kWidth, kHeight, 1.0);
  Canvas canvas(kWidth, kHeight);
  chart.draw(canvas, 0, 0, 2.0);
  const Point top = chart.place(1.0, 9.0);
  bool seen = false;
  for (int x = static_cast<int>(top.x) - 2; x <= static_cast<int>(top.x) + 2; ++x) {
    const std::uint8_t* p = canvas.pixels() + 4 * (static_cast<int>(top.y) * kWidth + x);
    seen |= p[0] > p[2] + 80;  // the first line is blue
  }
  EXPECT_TRUE(seen);
}

TEST(Chart, TheRangeContainsAllValuesOfTheWindowAndZero) {
  const ChartRange range = chart_range({ramp()}, 0.5, 1.5);
  EXPECT_EQ(range.from_s, 0.5);
  EXPECT_EQ(range.to_s, 1.5);
  EXPECT_EQ(range.lowest, 0.0);
  EXPECT_GT(range.highest, 7.5);
  EXPECT_LT(range.highest, 9.0);
}

TEST(Series, InterpolatesLinearly) {
  const Series series = ramp().series;
  EXPECT_DOUBLE_EQ(series.at(0.5), 2.5);
  EXPECT_DOUBLE_EQ(series.at(1.0), 5.0);
  EXPECT_DOUBLE_EQ(series.at(-1.0), 0.0);
  EXPECT_DOUBLE_EQ(series.at(3.0), 10.0);
}

}  // namespace
}  // namespace breakwater::chart_test
