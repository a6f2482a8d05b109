// How the things of a run's scene moved, at a video's rate.
#pragma once

#include <string>
#include <vector>

#include <breakwater/pictures/staging.h>
#include <breakwater/render/scene_description.h>

namespace breakwater {

/// Times that rise by a constant step.
struct TimeSpan {
  double from_s = 0.0;
  double step_s = 0.0;
  std::size_t count = 0;
};

/// When a replay's frames are: 60 a second, and in a window that is shown in slow motion as many
/// for each second of watching, as far as the log has them. Fewer where that were more than a page
/// can hold.
std::vector<TimeSpan> replay_times(const std::vector<double>& log_times_s, const Window& window);

/// The times one by one.
std::vector<double> times_of(const std::vector<TimeSpan>& spans);

/// Poses over time, one for each frame.
using PoseTrack = std::vector<Pose>;

/// A geom that is not always drawn: where that changes, the frame.
struct Visibility {
  int geom = 0;
  bool at_first = true;
  std::vector<std::size_t> changes;
};

struct ReplayMotion {
  std::vector<PoseTrack> bodies;   ///< for each of the model's
  std::vector<PoseTrack> cameras;  ///< the same
  std::vector<PoseTrack> lights;   ///< the same
  std::vector<int> geoms;          ///< those that are drawn at one frame at least
  std::vector<Visibility> visibility;
  /// Whether something else of the model changed in the pictures: a colour, or where a geom is on
  /// its body.
  bool is_incomplete = false;
};

/// Poses of the run's scene at these times, from its log. Throws RenderError.
ReplayMotion replay_motion(PictureRun& run, const std::vector<double>& times_s);

}  // namespace breakwater
