// An OpenGL context without a screen, from any library.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <breakwater/render/opengl_library.h>

namespace breakwater {

/// The memory for its pictures: rows from the top, 4 bytes per pixel, blue first.
struct OpenGlTarget {
  int width;
  int height;
  std::uint8_t* pixels;  ///< must outlive the context
};

/// It is current on the thread that made it until it is destroyed.
class OpenGlContext {
 public:
  OpenGlContext() = default;
  OpenGlContext(const OpenGlContext&) = delete;
  OpenGlContext& operator=(const OpenGlContext&) = delete;
  virtual ~OpenGlContext() = default;

  /// "OSMesa" or "EGL".
  virtual const char* library() const = 0;
  /// Waits until everything is drawn into the target.
  virtual void finish() = 0;

  /// A function of OpenGL. Throws RenderError if there is none with this name.
  template <typename Function>
  Function* function(const char* name) const {
    void* const address = find(name);
    if (address == nullptr) throw NoOpenGl(std::string(library()) + " has no " + name);
    return reinterpret_cast<Function*>(address);
  }

 private:
  virtual void* find(const char* name) const = 0;
};

/// Makes a context of Mesa's software renderer, which draws into the target. Throws RenderError.
std::unique_ptr<OpenGlContext> make_osmesa_context(const OpenGlTarget& target);

/// EGL devices to try, without any window system.
struct EglDevices {
  std::optional<int> number;   ///< try only this one
  bool software_only = false;  ///< false: all, in EGL's order: GPUs first, if any
};
/// Throws RenderError.
std::unique_ptr<OpenGlContext> make_egl_context(const OpenGlTarget& target,
                                                const EglDevices& devices);

}  // namespace breakwater
