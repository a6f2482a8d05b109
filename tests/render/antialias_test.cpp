// Smoothed edges compared with the area that a pixel has on each side.
#include <breakwater/render/picture.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace breakwater {
namespace {

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

TEST(EdgeSmoother, AtLeastHalvesTheErrorOfSlantedEdges) {
  for (const double slope : {0.08, 0.15, 0.3, 0.45, -0.12}) {
    const auto exact = half_plane(slope, 16);
    const auto jagged = half_plane(slope, 1);
    auto smooth = jagged;
    EdgeSmoother().smooth(smooth, kSize, kSize);
    EXPECT_LT(mean_error(smooth, exact), 0.5 * mean_error(jagged, exact)) << "slope " << slope;
  }
}

TEST(EdgeSmoother, LeavesStraightEdgesAndFlatAreasAlone) {
  // Along x = 80 no pixel is partly covered.
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(4 * kSize * kSize), 50);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i / 4 % kSize >= 80) pixels[i] = 180;
  }
  auto smooth = pixels;
  EdgeSmoother().smooth(smooth, kSize, kSize);
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

TEST(EdgeSmoother, DependsOnlyOnThePicture) {
  EdgeSmoother used;
  auto first = half_plane(0.2, 1);
  used.smooth(first, kSize, kSize);
  auto again = half_plane(0.2, 1);
  used.smooth(again, kSize, kSize);
  EXPECT_EQ(first, again);
}

}  // namespace
}  // namespace breakwater
