#include <breakwater/render/antialias.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace breakwater {
namespace {

// Smaller steps of luminance are no edges; FXAA uses 1/16.
constexpr std::uint8_t kSmallestContrast = 16;
// Steps below this share of the local maximum are no edges either; FXAA uses 1/8.
constexpr int kRelativeContrast = 8;
// How far to follow an edge to each side, in pixels.
constexpr int kReach = 16;
// How strongly to dim single bright or dark pixels.
constexpr float kSubpixel = 0.5F;

// The luminance around one pixel, in the directions along and across the edge.
struct Edge {
  std::ptrdiff_t along;
  std::ptrdiff_t across;  // towards the steeper side
  float middle;           // the luminance halfway across
  float gradient;         // largest change of the halfway luminance along the edge
};

std::uint32_t blend(const std::uint8_t* a, const std::uint8_t* b, float share_of_b) {
  const int weight = static_cast<int>(std::lround(share_of_b * 256.0F));
  std::array<std::uint8_t, 4> mixed{};
  for (std::size_t i = 0; i < 4; ++i) {
    mixed[i] = static_cast<std::uint8_t>((a[i] * (256 - weight) + b[i] * weight + 128) >> 8);
  }
  std::uint32_t colour = 0;
  std::memcpy(&colour, mixed.data(), 4);
  return colour;
}

// The end of an edge, and its difference of luminance from the middle.
struct End {
  int distance;
  float difference;
  bool found;  // false: the picture or the reach ended first
};

End follow(const std::uint8_t* luma, const Edge& edge, std::ptrdiff_t step, int room) {
  End end{0, 0.0F, false};
  const int reach = std::min(room, kReach);
  while (end.distance < reach) {
    luma += step;
    ++end.distance;
    end.difference = 0.5F * static_cast<float>(luma[0] + luma[edge.across]) - edge.middle;
    end.found = std::abs(end.difference) >= edge.gradient;
    if (end.found) break;
  }
  return end;
}

// Returns the share of the neighbour across the edge in the pixel's new colour, and sets `across`.
float share(const std::uint8_t* luma, std::ptrdiff_t width, int x, int y, int height,
            std::ptrdiff_t& across) {
  const std::ptrdiff_t w = width;
  const int c = luma[0];
  const int n = luma[-w];
  const int s = luma[w];
  const int e = luma[1];
  const int o = luma[-1];
  const int ne = luma[1 - w];
  const int nw = luma[-1 - w];
  const int se = luma[1 + w];
  const int sw = luma[-1 + w];

  const int horizontal =
      std::abs(nw - 2 * o + sw) + 2 * std::abs(n - 2 * c + s) + std::abs(ne - 2 * e + se);
  const int vertical =
      std::abs(nw - 2 * n + ne) + 2 * std::abs(o - 2 * c + e) + std::abs(sw - 2 * s + se);
  const bool is_horizontal = horizontal >= vertical;
  const int before = is_horizontal ? n : o;
  const int after = is_horizontal ? s : e;
  const bool steeper_before = std::abs(before - c) >= std::abs(after - c);

  Edge edge{};
  edge.along = is_horizontal ? 1 : w;
  across = (is_horizontal ? w : 1) * (steeper_before ? -1 : 1);
  edge.across = across;
  const int other = steeper_before ? before : after;
  edge.middle = 0.5F * static_cast<float>(c + other);
  edge.gradient = 0.25F * static_cast<float>(std::abs(other - c));

  const int room_before = is_horizontal ? x - 1 : y - 1;
  const int room_after = is_horizontal ? static_cast<int>(width) - 2 - x : height - 2 - y;
  const End back = follow(luma, edge, -edge.along, room_before);
  const End forth = follow(luma, edge, edge.along, room_after);
  const End& nearer = back.distance < forth.distance ? back : forth;

  // The line between the ends covers this pixel only if the nearer end turns the other way.
  float along_edge = 0.0F;
  const bool below_middle = static_cast<float>(c) < edge.middle;
  if (nearer.found && (nearer.difference < 0.0F) != below_middle) {
    along_edge = 0.5F - static_cast<float>(nearer.distance) /
                            static_cast<float>(back.distance + forth.distance);
  }

  const int highest = std::max({c, n, s, e, o});
  const int lowest = std::min({c, n, s, e, o});
  const float average = static_cast<float>(2 * (n + s + e + o) + ne + nw + se + sw) / 12.0F;
  const float stands_out = std::clamp(
      std::abs(average - static_cast<float>(c)) / static_cast<float>(highest - lowest), 0.0F, 1.0F);
  const float smooth = (3.0F - 2.0F * stands_out) * stands_out * stands_out;
  return std::max(along_edge, smooth * smooth * kSubpixel);
}

// The compiler can vectorise the two loops over all pixels.

// Rec. 601 in integers of 1/256.
void take_luma(const std::uint8_t* __restrict pixels, std::uint8_t* __restrict luma,
               std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t p = 0;
    std::memcpy(&p, pixels + 4 * i, sizeof(p));
    const std::uint32_t blue = p & 255U;
    const std::uint32_t green = (p >> 8U) & 255U;
    const std::uint32_t red = (p >> 16U) & 255U;
    luma[i] = static_cast<std::uint8_t>((29U * blue + 150U * green + 77U * red) >> 8U);
  }
}

// Marks the pixels of a row that differ enough from a neighbour, except the first and the last.
void find_contrast(const std::uint8_t* __restrict row, const std::uint8_t* __restrict above,
                   const std::uint8_t* __restrict below, std::uint8_t* __restrict contrast,
                   std::size_t width) {
  const auto max = [](std::uint8_t a, std::uint8_t b) { return a > b ? a : b; };
  const auto min = [](std::uint8_t a, std::uint8_t b) { return a < b ? a : b; };
  for (std::size_t x = 1; x + 1 < width; ++x) {
    const std::uint8_t high =
        max(max(max(above[x], below[x]), max(row[x - 1], row[x + 1])), row[x]);
    const std::uint8_t low = min(min(min(above[x], below[x]), min(row[x - 1], row[x + 1])), row[x]);
    const auto range = static_cast<std::uint8_t>(high - low);
    const std::uint8_t least =
        max(kSmallestContrast, static_cast<std::uint8_t>(high / kRelativeContrast));
    contrast[x] = range >= least ? 1 : 0;
  }
}

}  // namespace

void EdgeSmoother::smooth(std::vector<std::uint8_t>& pixels, int width, int height) {
  const auto w = static_cast<std::ptrdiff_t>(width);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  luma_.resize(count);
  contrast_.assign(static_cast<std::size_t>(width) + 8, 0);
  smoothed_.clear();
  take_luma(pixels.data(), luma_.data(), count);

  for (int y = 1; y + 1 < height; ++y) {
    const std::uint8_t* const row = luma_.data() + y * w;
    find_contrast(row, row - w, row + w, contrast_.data(), static_cast<std::size_t>(width));
    for (int block = 0; block < width; block += 8) {
      std::uint64_t any = 0;  // most of a picture is flat: test eight pixels at once
      std::memcpy(&any, &contrast_[static_cast<std::size_t>(block)], sizeof(any));
      if (any == 0) continue;
      for (int x = std::max(block, 1); x < std::min(block + 8, width - 1); ++x) {
        if (contrast_[static_cast<std::size_t>(x)] == 0) continue;
        std::ptrdiff_t across = 0;
        const float part = share(row + x, w, x, y, height, across);
        if (part <= 0.0F) continue;
        const std::ptrdiff_t pixel = y * w + x;
        smoothed_.push_back({static_cast<std::size_t>(pixel),
                             blend(&pixels[static_cast<std::size_t>(4 * pixel)],
                                   &pixels[static_cast<std::size_t>(4 * (pixel + across))], part)});
      }
    }
  }
  for (const Smoothed& s : smoothed_) std::memcpy(&pixels[4 * s.pixel], &s.colour, 4);
}

}  // namespace breakwater
