// Clean edges without drawing more pixels.
#pragma once

#include <cstdint>
#include <vector>

namespace breakwater {

/// Smooths the stairs on the edges of a picture, in place, after Lottes, "FXAA" (NVIDIA, 2009),
/// in its "quality" form: where the luminance changes abruptly, it looks along the edge for both
/// its ends, and blends a pixel with the one across the edge as far as the straight line between
/// the ends would cover it. It costs a few milliseconds, for edges alone; 4 samples a pixel cost
/// llvmpipe more than drawing the picture twice.
///
/// `pixels` has 4 bytes a pixel (blue, green, red, any). Keeps its memory between pictures.
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
