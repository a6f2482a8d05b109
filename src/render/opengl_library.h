// Libraries with OpenGL, loaded when the first picture is drawn.
#pragma once

#include <string>

#include <breakwater/record/loaded_library.h>
#include <breakwater/render/render_error.h>

namespace breakwater {

/// An error of one line, with the usual beginning for a machine that cannot draw.
struct NoOpenGl : RenderError {
  explicit NoOpenGl(const std::string& reason) : RenderError("pictures need OpenGL: " + reason) {}
};

/// Each function loads its library at the first call. MuJoCo looks once for OpenGL in the loaded
/// libraries, so a process draws with only one of them.
const LoadedLibrary& osmesa_library();
const LoadedLibrary& egl_library();

}  // namespace breakwater
