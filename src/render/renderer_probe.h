// What can draw on this machine.
#pragma once

#include <optional>
#include <string>

namespace breakwater {

struct RendererProbe {
  enum class Outcome { draws, no_library, no_context };
  Outcome outcome = Outcome::no_context;
  std::string words;  ///< Offscreen::renderer(), or one line: why not
};

/// Makes an Offscreen with MUJOCO_GL as it is or, for a moment, as given; in a process of its own:
/// a process draws by one library, and a driver may crash. Call it while no other thread runs.
/// Throws std::invalid_argument as opengl_asked().
RendererProbe probe_renderer(const std::optional<std::string>& mujoco_gl = std::nullopt);

}  // namespace breakwater
