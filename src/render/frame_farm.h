// Frames drawn by several processes, taken in order.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

namespace breakwater {

/// Draws frame `number` into memory of the farm's `frame_bytes`.
using DrawFrame = std::function<void(std::size_t number, std::uint8_t* frame)>;

/// What one process draws with, and what that calls itself, in at most 400 characters.
struct Drawer {
  // NOLINTNEXTLINE(google-explicit-constructor): what has no name is just its function.
  Drawer(DrawFrame draw_frame, std::string name = "")
      : draw(std::move(draw_frame)), renderer(std::move(name)) {}

  DrawFrame draw;
  std::string renderer;
};

struct FrameFarm {
  std::size_t frames = 0;
  std::size_t frame_bytes = 0;
  unsigned processes = 1;
  const std::atomic<bool>* stop = nullptr;             ///< ends the work when it becomes true
  std::function<void(double fraction_done)> progress;  ///< may be empty
};

/// Thrown when asked to stop.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped") {}
};

/// Each child process, forked from this one, calls `start` once, with its number, and what that
/// returns for every frame that it is given; a frame is whoever's turn comes first. Mesa draws no
/// faster with several contexts on the threads of one process, and children take no crash of a
/// driver to the parent. `take` gets all frames in order, on a thread of its own.
///
/// Call it while no other thread runs. Returns the name of what drew. Throws RenderError with a
/// child's message if one fails, what `take` throws, or Stopped.
std::string draw_frames(const FrameFarm& farm,
                        const std::function<Drawer(std::size_t process)>& start,
                        const std::function<void(const std::uint8_t* frame)>& take);

}  // namespace breakwater
