// OpenGL without a screen.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/render/opengl_context.h>

namespace breakwater {

/// An OpenGL context that draws into memory. It is current on the thread that makes it; a thread
/// has one at a time. What draws: what MUJOCO_GL and MUJOCO_EGL_DEVICE_ID ask for, OSMesa or EGL;
/// if they ask for nothing OSMesa where it is there, else Mesa's software renderer through EGL, so
/// that pictures are the same on every machine. The first one that a process makes decides for all.
class Offscreen {
 public:
  /// Throws RenderError if there is no such OpenGL, or if the size is more than it can do;
  /// std::invalid_argument as opengl_asked().
  Offscreen(int width, int height);
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  /// Waits until all is drawn, and brings pixels() up to date.
  void finish() { context_->finish(); }
  /// Rows from the top; 4 bytes a pixel: blue, green, red, and 0 where nothing was drawn. May be
  /// changed: what is drawn later does not build on it.
  std::vector<std::uint8_t>& pixels() { return pixels_; }

  /// A function of OpenGL's. Throws RenderError if there is none of that name.
  template <typename Function>
  Function* function(const char* name) const {
    return context_->function<Function>(name);
  }

  /// What OpenGL calls itself, and the library: "llvmpipe (LLVM 15.0.6, 256 bits), OSMesa".
  const std::string& renderer() const { return renderer_; }
  /// What a user should know, in one line, if it is a software renderer other than llvmpipe: what
  /// Mesa falls back to is some 15 times slower.
  std::optional<std::string> slowness() const;

 private:
  int width_;
  int height_;
  std::vector<std::uint8_t> pixels_;
  std::unique_ptr<OpenGlContext> context_;
  std::string renderer_;
};

}  // namespace breakwater
