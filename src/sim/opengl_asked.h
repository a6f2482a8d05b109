// The OpenGL library that the user selects, by the environment variables of MuJoCo's programs.
#pragma once

#include <optional>

namespace breakwater {

struct OpenGlAsked {
  enum class Library { any, osmesa, egl };
  Library library = Library::any;
  std::optional<int> egl_device;  ///< number in EGL's list; only with `egl`
};

/// Reads MUJOCO_GL (`egl` or `osmesa`, in upper or lower case; unset or empty: any) and
/// MUJOCO_EGL_DEVICE_ID (a whole number). A device selects EGL if MUJOCO_GL is unset, and has no
/// effect with `osmesa`. Throws std::invalid_argument, one line, for other values.
OpenGlAsked opengl_asked();

}  // namespace breakwater
