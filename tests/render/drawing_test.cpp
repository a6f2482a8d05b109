// Parts of a frame that are drawn: smooth edges, charts, colours and a name.
#include "support.h"

#include <breakwater/render/chart.h>
#include <breakwater/render/line_style.h>
#include <breakwater/render/picture.h>

namespace breakwater::drawing_test {

constexpr int kSize = 160;

// A half plane, bright below the line y = y0 + slope·x, sampled at pixel centres or averaged over
// 16×16 points per pixel.
std::vector<std::uint8_t> half_plane(double slope, int samples) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(4 * kSize * kSize));
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      int inside = 0;
      for (int i = 0; i < samples * samples; ++i) {
        const double px = x + (i % samples + 0.5) / samples;
        const double py = y + (i / samples + 0.5) / samples;
        inside += py > 0.4 * kSize + slope * px ? 1 : 0;
      }
      const double part = static_cast<double>(inside) / (samples * samples);
      std::fill_n(&pixels[static_cast<std::size_t>(4 * (y * kSize + x))], 4,
                  static_cast<std::uint8_t>(std::lround(40.0 + 180.0 * part)));
    }
  }
  return pixels;
}

double mean_error(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0.0;
  int count = 0;
  for (int y = 1; y + 1 < kSize; ++y) {
    for (int x = 30; x + 30 < kSize;
         ++x) {  // near the border the ends of a step are out of the picture
      const auto i = static_cast<std::size_t>(4 * (y * kSize + x));
      sum += std::abs(a[i] - b[i]);
      ++count;
    }
  }
  return sum / count;
}

TEST(SmoothEdges, AtLeastHalvesTheErrorOfSlantedEdges) {
  for (const double slope : {0.08, 0.15, 0.3, 0.45, -0.12}) {
    const auto exact = half_plane(slope, 16);
    const auto jagged = half_plane(slope, 1);
    auto smooth = jagged;
    smooth_edges(smooth, kSize, kSize);
    EXPECT_LT(mean_error(smooth, exact), 0.5 * mean_error(jagged, exact)) << "slope " << slope;
  }
}

TEST(SmoothEdges, LeavesStraightEdgesAndFlatAreasAlone) {
  // Along x = 80 no pixel is partly covered.
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(4 * kSize * kSize), 50);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i / 4 % kSize >= 80) pixels[i] = 180;
  }
  auto smooth = pixels;
  smooth_edges(smooth, kSize, kSize);
  int largest = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto x = static_cast<int>(i / 4 % kSize);
    const int change = std::abs(smooth[i] - pixels[i]);
    if (x < 79 || x > 80) {
      EXPECT_EQ(change, 0);
    }
    largest = std::max(largest, change);
  }
  // FXAA also softens an edge slightly against sub-pixel aliasing.
  EXPECT_LE(largest, 12);
}

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
  EXPECT_DOUBLE_EQ(series.at(0.5).value, 2.5);
  EXPECT_DOUBLE_EQ(series.at(1.0).value, 5.0);
  EXPECT_DOUBLE_EQ(series.at(-1.0).value, 0.0);
  EXPECT_DOUBLE_EQ(series.at(3.0).value, 10.0);
}

TEST(LineStyle, EachColourHasADashAndTheyComeAgainWithOthers) {
  std::set<std::pair<std::string, int>> pairs;
  constexpr int kAll = kStyleColours * kStyleDashes;
  for (LineStyle i = 0; i < kAll; ++i) pairs.emplace(light_colour(i), dash_number(i));
  EXPECT_EQ(pairs.size(), kAll);
}

TEST(LineStyle, ASignalsRoleHasItsColourAndNoTwoLinesHaveTheSame) {
  EXPECT_EQ(role_of_signal("force_true_N"), role_of_signal("physics/force_true_N"));
  EXPECT_EQ(role_of_signal("force.reference_N"), kReferenceStyle);
  EXPECT_EQ(role_of_signal("error_m[3]"), std::nullopt);
  EXPECT_EQ(distinct_styles({1, std::nullopt, 1, kReferenceStyle, kReferenceStyle}),
            (std::vector<LineStyle>{1, 0, 2, kReferenceStyle, kReferenceStyle}));
  EXPECT_EQ(candidate_styles({"b", "mine"}, {"a", "b"}), (std::vector<LineStyle>{1, 0}));
}

TEST(LineStyle, TheScriptOfFiguresHasTheSame) {
  std::ifstream file(testing::source_file("scripts/figures.py"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::string colours;
  for (LineStyle i = 0; i < kStyleColours; ++i) {
    colours += "\"" + std::string(light_colour(i)) + "\", ";
  }
  colours += "\"" + std::string(light_colour(kReferenceStyle)) + "\"";
  EXPECT_NE(text.find("COLOURS = [" + colours + "]"), std::string::npos) << colours;
}

}  // namespace breakwater::drawing_test
