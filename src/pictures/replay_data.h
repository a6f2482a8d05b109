// The data with which a page replays runs in three dimensions.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>

namespace breakwater {

/// The times of a replay's frames: 30 per second. A window in slow motion has 30 per second of
/// watching, as far as the log has them. There are fewer if a page could not hold so many.
std::vector<double> replay_times(const std::vector<double>& log_times_s, const Window& window);

struct ReplayData {
  nlohmann::ordered_json json;  ///< for data/report/replay
  PictureStage stage;           ///< the runs prepared for pictures; notes on what the page lacks
  Window window;                ///< the shot list's window for these runs
};

/// The scenes and motions of up to kMostRuns runs. Looks come from the compiled models, poses and
/// arrows from the logs, and waves from their components. `camera`, if not empty, replaces that of
/// the shot list. Throws std::invalid_argument, one line, or RenderError.
ReplayData replay_data(ShownRuns runs, const ShotList& shots, const std::string& camera = "");

}  // namespace breakwater
