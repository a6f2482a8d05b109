// Which OpenGL a user asks for, in the words of MuJoCo's own programs.
#pragma once

#include <optional>

namespace breakwater {

struct OpenGlAsked {
  enum class Library { any, osmesa, egl };
  Library library = Library::any;
  std::optional<int> egl_device;  ///< its number in EGL's list; only with `egl`
};

/// What MUJOCO_GL (`egl` or `osmesa`, in upper or lower case; unset or empty: any) and
/// MUJOCO_EGL_DEVICE_ID (a whole number) say. A device is one of EGL's: it asks for EGL where
/// MUJOCO_GL is unset, and is not looked at beside `osmesa`. Throws std::invalid_argument, one
/// line, if they say anything else.
OpenGlAsked opengl_asked();

}  // namespace breakwater
