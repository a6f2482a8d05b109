#include <breakwater/render/opengl_library.h>

#include <dlfcn.h>

namespace breakwater {

RenderError no_opengl(const std::string& reason) {
  RenderError error("pictures need OpenGL: " + reason);
  return error;
}

// The symbols are global, so that MuJoCo finds them.
OpenGlLibrary::OpenGlLibrary(const char* file, const char* debian_package)
    : file_(file), handle_(dlopen(file, RTLD_NOW | RTLD_GLOBAL)) {
  if (handle_ != nullptr) return;
  complaint_ = std::string(dlerror()) + " (Debian package " + debian_package + ")";
}

void* OpenGlLibrary::find(const char* name) const {
  return dlsym(handle_, name);
}

const OpenGlLibrary& osmesa_library() {
  static const OpenGlLibrary library("libOSMesa.so.8", "libosmesa6");
  return library;
}

const OpenGlLibrary& egl_library() {
  static const OpenGlLibrary library("libEGL.so.1", "libegl1");
  return library;
}

}  // namespace breakwater
