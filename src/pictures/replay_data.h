// The data with which a page replays runs in three dimensions.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <breakwater/pictures/finished_run.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/render/scene_description.h>

namespace breakwater {

/// Times with a constant step.
struct TimeSpan {
  double from_s = 0.0;
  double step_s = 0.0;
  std::size_t count = 0;
};

/// The times of a replay's frames: 30 per second. A window in slow motion has 30 per second of
/// watching, as far as the log has them. There are fewer if a page could not hold so many.
std::vector<TimeSpan> replay_times(const std::vector<double>& log_times_s, const Window& window);

/// The single times.
std::vector<double> times_of(const std::vector<TimeSpan>& spans);

/// Poses over time, one for each frame.
using PoseTrack = std::vector<Pose>;

/// A geom that is visible only at times, and the frames at which this changes.
struct Visibility {
  int geom = 0;
  bool at_first = true;
  std::vector<std::size_t> changes;
};

struct ReplayMotion {
  std::vector<PoseTrack> bodies;   ///< for each body of the model
  std::vector<PoseTrack> cameras;  ///< for each camera
  std::vector<PoseTrack> lights;   ///< for each light
  std::vector<int> geoms;          ///< geoms that are visible in at least one frame
  std::vector<Visibility> visibility;
  /// Whether something else changed in the pictures: a colour, or the place of a geom on its body.
  bool is_incomplete = false;
};

/// The poses of the run's scene at these times, from its log. Throws RenderError.
ReplayMotion replay_motion(PictureRun& run, const std::vector<double>& times_s);

struct ReplayData {
  nlohmann::ordered_json json;     ///< for data/report/replay
  std::vector<PictureRun> staged;  ///< the runs prepared for pictures, for charts
  std::vector<LineStyle> styles;   ///< one for each run
  Window window;                   ///< the shot list's window for these runs
  Window whole;                    ///< the whole longest run
  std::vector<std::string> notes;  ///< missing things on the page, one line each
};

/// The scenes and motions of up to kMostRuns runs, with a label for each. Looks come from the
/// compiled models, poses and arrows from the logs, and waves from their components. `camera`, if
/// not empty, replaces that of the shot list. Throws std::invalid_argument, one line, or
/// RenderError.
ReplayData replay_data(ShownRuns runs, const std::vector<std::string>& labels,
                       const ShotList& shots, const std::string& camera = "");

}  // namespace breakwater
