#include <breakwater/pictures/motion_codec.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr double kLargest = 4e15;  // whole numbers below it are exact, also in a browser

}  // namespace

void append_channel(std::span<const double> values, double unit, std::vector<std::uint8_t>& bytes) {
  std::int64_t last = 0;
  for (const double value : values) {
    const double exact = value / unit;
    const std::int64_t now =
        std::isfinite(exact) ? std::llround(std::clamp(exact, -kLargest, kLargest)) : last;
    const std::int64_t step = now - last;
    last = now;
    std::uint64_t left =
        static_cast<std::uint64_t>(step) << 1U ^ static_cast<std::uint64_t>(step >> 63);
    while (left >= 128U) {
      bytes.push_back(static_cast<std::uint8_t>(left & 127U) | 128U);
      left >>= 7U;
    }
    bytes.push_back(static_cast<std::uint8_t>(left));
  }
}

std::vector<double> read_channel(std::span<const std::uint8_t> bytes, std::size_t& at,
                                 std::size_t count, double unit) {
  std::vector<double> values;
  std::int64_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t word = 0;
    std::uint8_t byte = 128U;
    for (unsigned shift = 0; (byte & 128U) != 0; shift += 7) {
      if (at >= bytes.size() || shift > 63) throw std::invalid_argument("a channel is cut off");
      byte = bytes[at++];
      word |= static_cast<std::uint64_t>(byte & 127U) << shift;
    }
    last += static_cast<std::int64_t>(word >> 1U) ^ -static_cast<std::int64_t>(word & 1U);
    values.push_back(static_cast<double>(last) * unit);
  }
  return values;
}

}  // namespace breakwater
