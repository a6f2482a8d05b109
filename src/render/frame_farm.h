// Frames drawn by several processes, and passed on in order.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

namespace breakwater {

/// Draws frame `number` into memory of `frame_bytes` bytes.
using DrawFrame = std::function<void(std::size_t number, std::uint8_t* frame)>;

/// The drawing function of one process, and the name of its renderer in at most 400 characters.
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

/// Thrown if the work was asked to stop.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped") {}
};

/// Draws frames in child processes, forked from this one. Each child calls `start` once, with its
/// number, and the result for each of its frames, in turn with the others. Several contexts in one
/// process would not be faster with Mesa, and a crash of a driver would end the process. `take`
/// gets all frames in order, while the children draw the next ones.
///
/// Call it while no other thread runs. Returns the name of the renderer. Throws RenderError with a
/// child's message if one fails, the exception of `take`, or Stopped.
std::string draw_frames(const FrameFarm& farm,
                        const std::function<Drawer(std::size_t process)>& start,
                        const std::function<void(const std::uint8_t* frame)>& take);

}  // namespace breakwater
