// Tests whether this machine can draw.
#pragma once

#include <optional>
#include <string>

namespace breakwater {

struct RendererProbe {
  enum class Outcome { draws, no_library, no_context };
  Outcome outcome = Outcome::no_context;
  std::string words;  ///< Offscreen::renderer(), or the reason of the failure in one line
};

/// Makes an Offscreen with the present MUJOCO_GL, or with the given one. It uses a new process: a
/// process draws with one library only, and a driver may crash. Call it while no other thread runs.
/// Throws std::invalid_argument as opengl_asked().
RendererProbe probe_renderer(const std::optional<std::string>& mujoco_gl = std::nullopt);

}  // namespace breakwater
