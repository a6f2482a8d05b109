// An OpenGL context without a screen, whichever library makes it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <breakwater/render/opengl_library.h>

namespace breakwater {

/// Where its pictures go: rows from the top, 4 bytes a pixel, blue first.
struct OpenGlTarget {
  int width;
  int height;
  std::uint8_t* pixels;  ///< outlives the context
};

/// Current on the thread that made it, until it goes.
class OpenGlContext {
 public:
  OpenGlContext() = default;
  OpenGlContext(const OpenGlContext&) = delete;
  OpenGlContext& operator=(const OpenGlContext&) = delete;
  virtual ~OpenGlContext() = default;

  /// "OSMesa" or "EGL".
  virtual const char* library() const = 0;
  /// Waits until all is drawn, and has it in the target.
  virtual void finish() = 0;

  /// A function of OpenGL's. Throws RenderError if there is none of that name.
  template <typename Function>
  Function* function(const char* name) const {
    void* const address = find(name);
    if (address == nullptr) throw no_opengl(std::string(library()) + " has no " + name);
    return reinterpret_cast<Function*>(address);
  }

 private:
  virtual void* find(const char* name) const = 0;
};

/// Mesa's software renderer, which draws into the target itself. Throws RenderError.
std::unique_ptr<OpenGlContext> make_osmesa_context(const OpenGlTarget& target);

/// EGL without any window system, on one of the devices that it lists: which of them to try.
struct EglDevices {
  std::optional<int> number;   ///< this one alone
  bool software_only = false;  ///< else all, in EGL's order: GPUs first, if there are any
};
/// Throws RenderError.
std::unique_ptr<OpenGlContext> make_egl_context(const OpenGlTarget& target,
                                                const EglDevices& devices);

}  // namespace breakwater
