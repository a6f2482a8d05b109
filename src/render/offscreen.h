// OpenGL without a screen.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace breakwater {

/// An OpenGL context of Mesa's software renderer that draws into memory. It is current on the
/// thread that makes it; a thread has one at a time. Mesa is loaded when the first is made, so
/// that programs that draw nothing do not load it.
class Offscreen {
 public:
  /// Throws RenderError if there is no OSMesa, or if the size is more than it can do.
  Offscreen(int width, int height);
  ~Offscreen();
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  /// Waits until all is drawn, and brings pixels() up to date.
  void finish();
  /// Rows from the top; 4 bytes a pixel: blue, green, red, and 0 where nothing was drawn. May be
  /// changed: what is drawn later does not build on it.
  std::vector<std::uint8_t>& pixels() { return pixels_; }

  /// "llvmpipe (LLVM 15.0.6, 256 bits)".
  const std::string& renderer() const { return renderer_; }
  /// What a user should know, in one line, unless it is llvmpipe: what Mesa falls back to otherwise
  /// is some 15 times slower.
  std::optional<std::string> slowness() const;

 private:
  struct Mesa;

  int width_;
  int height_;
  std::vector<std::uint8_t> pixels_;
  std::unique_ptr<Mesa> mesa_;
  std::string renderer_;
};

}  // namespace breakwater
