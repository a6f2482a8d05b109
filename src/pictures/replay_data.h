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

/// The scenes and motions of runs that are staged for this window, for data/report/replay. Looks
/// come from the compiled models, poses and arrows from the logs, and waves from their components.
/// `stage` gets notes on what the page lacks. Throws RenderError.
nlohmann::ordered_json replay_data(ShownRuns runs, const ShotList& shots, const Window& window,
                                   PictureStage& stage);

}  // namespace breakwater
