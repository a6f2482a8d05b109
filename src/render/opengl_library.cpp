#include <breakwater/render/opengl_library.h>

namespace breakwater {

// The symbols are global, so that MuJoCo finds them.

const LoadedLibrary& osmesa_library() {
  static const LoadedLibrary library("libOSMesa.so.8", "libosmesa6", true);
  return library;
}

const LoadedLibrary& egl_library() {
  static const LoadedLibrary library("libEGL.so.1", "libegl1", true);
  return library;
}

}  // namespace breakwater
