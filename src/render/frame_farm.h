// Frames drawn by several processes, and passed on in order.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace breakwater {

/// The drawing function of one process, and the name of its renderer. The pixels that draw()
/// returns are valid until its next call.
struct Drawer {
  std::function<const std::uint8_t*(std::size_t number)> draw;
  std::string renderer = {};
};

struct FrameFarm {
  std::size_t frames = 0;
  std::size_t processes = 1;
  const std::atomic<bool>* stop = nullptr;             ///< ends the work when it becomes true
  std::function<void(double fraction_done)> progress;  ///< may be empty
};

/// Draws frames in child processes, forked from this one. Each child calls `start` once, with its
/// number, and the result for each of its frames, in turn with the others. Several contexts in one
/// process would not be faster with Mesa, and a crash of a driver would end the process. The child
/// that drew a frame calls `take`, one after the other, in the order of the frames.
///
/// Call it while no other thread runs. Returns the name of the renderer. Throws Interrupted, or if
/// a child fails, RenderError, or OutputError if `take` threw it.
std::string draw_frames(const FrameFarm& farm,
                        const std::function<Drawer(std::size_t process)>& start,
                        const std::function<void(const std::uint8_t* frame)>& take);

}  // namespace breakwater
