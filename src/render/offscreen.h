// OpenGL without a screen.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <breakwater/render/render_error.h>

namespace breakwater {

/// An error of one line, with the usual beginning for a machine that cannot draw.
struct NoOpenGl : RenderError {
  explicit NoOpenGl(const std::string& reason) : RenderError("pictures need OpenGL: " + reason) {}
};

/// An OpenGL context of EGL that draws into memory, without any window system. It is current on the
/// thread that makes it, and a thread has one at a time. It is Mesa's software renderer, so that
/// pictures are the same on every machine, unless opengl_asked() says otherwise.
class Offscreen {
 public:
  /// Throws NoOpenGl if there is no such OpenGL, or the size is too large for it. Throws
  /// std::invalid_argument as opengl_asked().
  Offscreen(int width, int height);
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;
  ~Offscreen();

  /// Why EGL's library is missing, with the package that has it; empty if it is there.
  static std::string missing_library();

  int width() const { return width_; }
  int height() const { return height_; }

  /// Waits until everything is drawn, and updates pixels().
  void finish();
  /// Rows from the top, with 4 bytes per pixel: blue, green, red, and 0 where nothing was drawn.
  /// The caller may change them: each picture is drawn anew.
  std::vector<std::uint8_t>& pixels() { return pixels_; }

  /// A function of OpenGL. Throws NoOpenGl if there is none with this name.
  template <typename Function>
  static Function* function(const char* name) {
    void* const address = find(name);
    if (address == nullptr) throw NoOpenGl(std::string("EGL has no ") + name);
    return reinterpret_cast<Function*>(address);
  }

  /// The name of the renderer and the library: "llvmpipe (LLVM 15.0.6, 256 bits), EGL".
  const std::string& renderer() const { return renderer_; }

 private:
  void open(void* device);
  void close();
  static void* find(const char* name);

  int width_;
  int height_;
  std::vector<std::uint8_t> pixels_;
  void *display_ = nullptr, *surface_ = nullptr, *context_ = nullptr;  // EGL's
  std::string renderer_;
};

}  // namespace breakwater
