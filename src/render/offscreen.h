// OpenGL without a screen.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/render/opengl_context.h>

namespace breakwater {

/// An OpenGL context that draws into memory. It is current on the thread that makes it, and a
/// thread has one at a time. MUJOCO_GL and MUJOCO_EGL_DEVICE_ID choose OSMesa or EGL. Without them
/// it is OSMesa, or Mesa's software renderer through EGL if OSMesa is missing: pictures are then
/// the same on every machine. The first choice of a process is valid for all later contexts.
class Offscreen {
 public:
  /// Throws RenderError if there is no such OpenGL, or the size is too large for it. Throws
  /// std::invalid_argument as opengl_asked().
  Offscreen(int width, int height);
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  /// Waits until everything is drawn, and updates pixels().
  void finish() { context_->finish(); }
  /// Rows from the top, with 4 bytes per pixel: blue, green, red, and 0 where nothing was drawn.
  /// The caller may change them: each picture is drawn anew.
  std::vector<std::uint8_t>& pixels() { return pixels_; }

  /// A function of OpenGL. Throws RenderError if there is none with this name.
  template <typename Function>
  Function* function(const char* name) const {
    return context_->function<Function>(name);
  }

  /// The name of the renderer and the library: "llvmpipe (LLVM 15.0.6, 256 bits), OSMesa".
  const std::string& renderer() const { return renderer_; }
  /// A warning, in one line, if it is a software renderer other than llvmpipe. Mesa's other
  /// renderers are about 15 times slower.
  std::optional<std::string> slowness() const;

 private:
  int width_;
  int height_;
  std::vector<std::uint8_t> pixels_;
  std::unique_ptr<OpenGlContext> context_;
  std::string renderer_;
};

}  // namespace breakwater
