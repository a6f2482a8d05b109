// A motion under the steps of a recorded input.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include <breakwater/identification/axis_model.h>

namespace breakwater {

/// Moves `motion` through a stretch, from one change of the delayed input or row to the next:
/// motion.advance(h, input), then motion.position().
template <typename Motion>
void follow(const AxisStretch& stretch, double delay, Motion motion, std::span<double> positions) {
  const std::vector<double>& changes = stretch.input_times_s;
  double now = stretch.times_s.front();
  positions.front() = motion.position();
  // The input that acts at the beginning. The first one also acts before its time.
  std::size_t i = static_cast<std::size_t>(
      std::upper_bound(changes.begin(), changes.end(), now - delay) - changes.begin());
  i = std::max<std::size_t>(i, 1) - 1;
  for (std::size_t k = 1; k < stretch.times_s.size(); ++k) {
    const double end = stretch.times_s[k];
    while (i + 1 < changes.size() && changes[i + 1] + delay < end) {
      const double change = changes[i + 1] + delay;
      if (change > now) {
        motion.advance(change - now, stretch.inputs[i]);
        now = change;
      }
      ++i;
    }
    motion.advance(end - now, stretch.inputs[i]);
    now = end;
    positions[k] = motion.position();
  }
}

}  // namespace breakwater
