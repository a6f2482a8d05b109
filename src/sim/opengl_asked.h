// The device of EGL that the user selects, by the environment variables of MuJoCo's programs.
#pragma once

#include <optional>

namespace breakwater {

struct OpenGlAsked {
  std::optional<int> device;  ///< number in EGL's list
  bool software_only = true;  ///< false: the first device that works, a GPU if there is one
};

/// Reads MUJOCO_GL, in upper or lower case: `egl` is any device; `osmesa`, unset or empty is Mesa's
/// software renderer. Reads MUJOCO_EGL_DEVICE_ID, a whole number without effect with `osmesa`.
/// Throws std::invalid_argument, one line, for other values.
OpenGlAsked opengl_asked();

}  // namespace breakwater
