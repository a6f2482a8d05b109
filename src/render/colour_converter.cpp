#include <breakwater/render/colour_converter.h>

#include <bit>
#include <cstring>

namespace breakwater {
namespace {

static_assert(std::endian::native == std::endian::little, "a pixel's blue is its lowest byte");

// The compiler can vectorise these loops: sixteen bits are enough, and the arrays do not overlap.

void split(const std::uint8_t* __restrict pixels, std::uint16_t* __restrict blue,
           std::uint16_t* __restrict green, std::uint16_t* __restrict red, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t p = 0;
    std::memcpy(&p, pixels + 4 * i, sizeof(p));
    blue[i] = static_cast<std::uint16_t>(p & 255U);
    green[i] = static_cast<std::uint16_t>((p >> 8U) & 255U);
    red[i] = static_cast<std::uint16_t>((p >> 16U) & 255U);
  }
}

void to_luma(const std::uint16_t* __restrict blue, const std::uint16_t* __restrict green,
             const std::uint16_t* __restrict red, std::uint8_t* __restrict luma,
             std::size_t count) {
  constexpr int kBlack = 16 * 256 + 128;
  for (std::size_t i = 0; i < count; ++i) {
    const auto y = static_cast<std::uint16_t>(16 * blue[i] + 157 * green[i] + 47 * red[i] + kBlack);
    luma[i] = static_cast<std::uint8_t>(y >> 8U);
  }
}

// Averages blocks of two by two pixels.
void to_means(const std::uint16_t* __restrict upper, const std::uint16_t* __restrict lower,
              std::uint16_t* __restrict means, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t above = 0;
    std::uint32_t below = 0;
    std::memcpy(&above, upper + 2 * i, sizeof(above));
    std::memcpy(&below, lower + 2 * i, sizeof(below));
    const std::uint32_t sums = above + below;  // two sums of sixteen bits
    means[i] = static_cast<std::uint16_t>(((sums & 0xFFFFU) + (sums >> 16U) + 2U) >> 2U);
  }
}

void to_chroma(const std::uint16_t* __restrict blue, const std::uint16_t* __restrict green,
               const std::uint16_t* __restrict red, std::uint8_t* __restrict cb,
               std::uint8_t* __restrict cr, std::size_t count) {
  const auto part = [](int sum) {
    return static_cast<std::uint8_t>(128 + (static_cast<std::int16_t>(sum + 128) >> 8));
  };
  for (std::size_t i = 0; i < count; ++i) {
    cb[i] = part(112 * blue[i] - 86 * green[i] - 26 * red[i]);
    cr[i] = part(112 * red[i] - 102 * green[i] - 10 * blue[i]);
  }
}

}  // namespace

std::size_t yuv420p_bytes(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3 / 2;
}

ColourConverter::ColourConverter(int width, int height)
    : width_(static_cast<std::size_t>(width)),
      height_(static_cast<std::size_t>(height)),
      upper_(width_),
      lower_(width_),
      means_(width_ / 2) {}

void ColourConverter::convert(const std::uint8_t* pixels, std::uint8_t* frame) {
  const std::size_t half = width_ / 2;
  std::uint8_t* const cb = frame + width_ * height_;
  std::uint8_t* const cr = cb + half * (height_ / 2);
  for (std::size_t y = 0; y + 1 < height_; y += 2) {
    std::size_t at = y;
    for (Row* row : {&upper_, &lower_}) {
      split(pixels + 4 * width_ * at, row->blue.data(), row->green.data(), row->red.data(), width_);
      to_luma(row->blue.data(), row->green.data(), row->red.data(), frame + width_ * at, width_);
      ++at;
    }
    to_means(upper_.blue.data(), lower_.blue.data(), means_.blue.data(), half);
    to_means(upper_.green.data(), lower_.green.data(), means_.green.data(), half);
    to_means(upper_.red.data(), lower_.red.data(), means_.red.data(), half);
    to_chroma(means_.blue.data(), means_.green.data(), means_.red.data(), cb + half * (y / 2),
              cr + half * (y / 2), half);
  }
}

}  // namespace breakwater
