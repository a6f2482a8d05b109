// A picture's colours as video encoders take them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace breakwater {

/// Bytes of one frame as the encoder takes it: planes Y', Cb, Cr, the latter two of half the width
/// and half the height.
std::size_t yuv420p_bytes(int width, int height);

/// Converts R'G'B' of eight bits to Y'CbCr by Rec. ITU-R BT.709-6, limited range:
/// Y' = .2126 R' + .7152 G' + .0722 B' on 16 … 235; Cb = (B' − Y')/1.8556 and
/// Cr = (R' − Y')/1.5748 on 16 … 240, each of the mean of two by two pixels and centred between
/// them. In integers, of 1/256: Y' is right to ±1, Cb and Cr to ±2.
class ColourConverter {
 public:
  /// Both even.
  ColourConverter(int width, int height);

  /// From 4 bytes a pixel (blue, green, red, unused) to yuv420p_bytes(). Allocates nothing.
  void convert(const std::uint8_t* pixels, std::uint8_t* frame);

 private:
  // A row's colours apart.
  struct Row {
    explicit Row(std::size_t width) : blue(width), green(width), red(width) {}
    std::vector<std::uint16_t> blue, green, red;
  };

  std::size_t width_;
  std::size_t height_;
  Row upper_, lower_;
  Row means_;  // of two by two pixels
};

}  // namespace breakwater
