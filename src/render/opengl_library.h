// A library that has OpenGL, loaded when the first picture is drawn.
#pragma once

#include <string>

#include <breakwater/render/render_error.h>

namespace breakwater {

/// One line that begins as all do that say why nothing can be drawn.
RenderError no_opengl(const std::string& reason);

/// Not linked: programs that draw nothing do not load it, and run where it is not. MuJoCo looks for
/// OpenGL in the libraries that the process has loaded, once: a process draws by one of them.
class OpenGlLibrary {
 public:
  OpenGlLibrary(const char* file, const char* debian_package);

  bool is_there() const { return handle_ != nullptr; }
  /// The loader's words if it is not there, with the package that has it.
  const std::string& complaint() const { return complaint_; }

  /// Null if it has no function of that name.
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

/// Each is looked for at the first call.
const OpenGlLibrary& osmesa_library();
const OpenGlLibrary& egl_library();

}  // namespace breakwater
