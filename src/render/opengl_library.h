// A library with OpenGL, loaded when the first picture is drawn.
#pragma once

#include <string>

#include <breakwater/render/render_error.h>

namespace breakwater {

/// An error of one line, with the usual beginning for a machine that cannot draw.
RenderError no_opengl(const std::string& reason);

/// It is not linked: programs that draw nothing do not load it, and also run without it. MuJoCo
/// looks once for OpenGL in the loaded libraries, so a process draws with only one of them.
class OpenGlLibrary {
 public:
  OpenGlLibrary(const char* file, const char* debian_package);

  bool is_there() const { return handle_ != nullptr; }
  /// The loader's error if the library is missing, with the package that has it.
  const std::string& complaint() const { return complaint_; }

  /// The function with this name, or null.
  void* find(const char* name) const;
  /// Throws RenderError.
  template <typename Function>
  Function* function(const char* name) const {
    if (!is_there()) throw no_opengl(complaint_);
    void* const address = find(name);
    if (address == nullptr) throw no_opengl(std::string(file_) + " has no " + name);
    return reinterpret_cast<Function*>(address);
  }

 private:
  const char* file_;
  void* handle_;
  std::string complaint_;
};

/// Each function loads its library at the first call.
const OpenGlLibrary& osmesa_library();
const OpenGlLibrary& egl_library();

}  // namespace breakwater
