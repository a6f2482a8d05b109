// The colours of a picture for the encoder, compared with the recommendation's formulas.
#include <breakwater/render/colour_converter.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace breakwater {
namespace {

struct Ycbcr {
  double y, cb, cr;
};

// Rec. ITU-R BT.709-6, 3 and 4, eight bits.
Ycbcr rec709(double red, double green, double blue) {
  const double y = (0.2126 * red + 0.7152 * green + 0.0722 * blue) / 255.0;
  return {16.0 + 219.0 * y, 128.0 + 224.0 * (blue / 255.0 - y) / 1.8556,
          128.0 + 224.0 * (red / 255.0 - y) / 1.5748};
}

TEST(ColourConverter, MatchesTheRecommendation) {
  constexpr int kWidth = 62, kHeight = 34;  // no multiple of a vector
  constexpr std::size_t kPixels = kWidth * kHeight;
  std::vector<std::uint8_t> pixels(4 * kPixels);
  std::mt19937 engine(1);
  for (std::uint8_t& byte : pixels) byte = static_cast<std::uint8_t>(engine() >> 24U);
  // Corners of the colour cube, in blocks of one colour.
  for (std::size_t k = 0; k < 8; ++k) {
    for (const std::size_t corner : {2 * k, 2 * k + 1, kWidth + 2 * k, kWidth + 2 * k + 1}) {
      for (std::size_t c = 0; c < 3; ++c) pixels[4 * corner + c] = (k >> c & 1U) != 0 ? 255 : 0;
    }
  }
  ColourConverter converter(kWidth, kHeight);
  std::vector<std::uint8_t> frame(yuv420p_bytes(kWidth, kHeight));
  converter.convert(pixels.data(), frame.data());

  const auto mean = [&](std::size_t x, std::size_t y, std::size_t side) {
    std::array<double, 3> bgr{};
    for (std::size_t i = 0; i < side * side; ++i) {
      const std::size_t pixel = (y * side + i / side) * kWidth + x * side + i % side;
      for (std::size_t c = 0; c < 3; ++c) {
        bgr[c] += pixels[4 * pixel + c] / static_cast<double>(side * side);
      }
    }
    return rec709(bgr[2], bgr[1], bgr[0]);
  };
  for (std::size_t y = 0; y < kHeight; ++y) {
    for (std::size_t x = 0; x < kWidth; ++x) {
      ASSERT_NEAR(frame[y * kWidth + x], mean(x, y, 1).y, 1.0) << x << ", " << y;
    }
  }
  for (std::size_t y = 0; y < kHeight / 2; ++y) {
    for (std::size_t x = 0; x < kWidth / 2; ++x) {
      const Ycbcr exact = mean(x, y, 2);
      const std::size_t at = kPixels + y * (kWidth / 2) + x;
      ASSERT_NEAR(frame[at], exact.cb, 2.0) << x << ", " << y;
      ASSERT_NEAR(frame[at + kPixels / 4], exact.cr, 2.0) << x << ", " << y;
    }
  }
}

// Grey has no colour, and black and white are the ends of the range.
TEST(ColourConverter, GreyStaysGrey) {
  for (int grey = 0; grey < 256; ++grey) {
    const std::vector<std::uint8_t> pixels(16, static_cast<std::uint8_t>(grey));
    ColourConverter converter(2, 2);
    std::array<std::uint8_t, 6> frame{};
    converter.convert(pixels.data(), frame.data());
    EXPECT_NEAR(frame[0], 16.0 + 219.0 * grey / 255.0, 0.75);
    EXPECT_EQ(frame[4], 128);
    EXPECT_EQ(frame[5], 128);
    if (grey % 255 == 0) {
      EXPECT_EQ(frame[0], grey == 0 ? 16 : 235);
    }
  }
}

}  // namespace
}  // namespace breakwater
