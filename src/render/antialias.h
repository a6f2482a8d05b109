// Smooth edges without drawing more pixels.
#pragma once

#include <cstdint>
#include <vector>

namespace breakwater {

/// Smooths the edges of a picture in place, after Lottes, "FXAA" (NVIDIA, 2009), in its "quality"
/// form. At an abrupt change of luminance it finds both ends of the edge. It blends a pixel with
/// the one across the edge, as far as the straight line between the ends covers it. This takes a
/// few milliseconds. With llvmpipe, 4 samples per pixel would more than double the time.
///
/// `pixels` has 4 bytes per pixel (blue, green, red, any). Keeps its memory between pictures.
class EdgeSmoother {
 public:
  void smooth(std::vector<std::uint8_t>& pixels, int width, int height);

 private:
  struct Smoothed {
    std::size_t pixel;
    std::uint32_t colour;
  };

  std::vector<std::uint8_t> luma_;
  std::vector<std::uint8_t> contrast_;
  std::vector<Smoothed> smoothed_;
};

}  // namespace breakwater
