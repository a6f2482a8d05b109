// The data with which a page replays runs in three dimensions.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <breakwater/pictures/finished_run.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>

namespace breakwater {

/// A run and its name on the page.
struct LabelledRun {
  const FinishedRun& run;
  std::string label;
};

struct ReplayData {
  nlohmann::ordered_json json;       ///< for data/report/replay
  std::vector<PictureRun> staged;    ///< the runs prepared for pictures, for charts
  std::vector<Identity> identities;  ///< one for each run
  Window window;                     ///< the shot list's window for these runs
  Window whole;                      ///< the whole longest run
  std::vector<std::string> notes;    ///< missing things on the page, one line each
};

/// The scenes and motions of up to kMostRuns runs. Looks come from the compiled models, poses and
/// arrows from the logs, and waves from their components. `camera`, if not empty, replaces that of
/// the shot list. Throws std::invalid_argument, one line, or RenderError.
ReplayData replay_data(const std::vector<LabelledRun>& runs, const ShotList& shots,
                       const std::string& camera = "");

}  // namespace breakwater
