// What a page needs to play runs in three dimensions.
#pragma once

#include <string>
#include <vector>

#include <breakwater/pictures/finished_run.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>

namespace breakwater {

/// A run and what it is called on the page.
struct LabelledRun {
  const FinishedRun& run;
  std::string label;
};

struct ReplayData {
  std::string json;                  ///< for data/report/replay.js; safe within <script>
  std::vector<PictureRun> staged;    ///< the runs as pictures have them, for charts
  std::vector<Identity> identities;  ///< of the runs
  Window window;                     ///< the shot list's, of these runs
  Window whole;                      ///< all of the longest run
  std::vector<std::string> notes;    ///< what the page cannot show, one line each
};

/// The scenes and motions of up to kMostRuns runs: looks from the compiled models, poses from the
/// logs, arrows as long as the log's signals, waves as their components. `camera` replaces the shot
/// list's unless empty. Throws std::invalid_argument, one line, or RenderError.
ReplayData replay_data(const std::vector<LabelledRun>& runs, const ShotList& shots,
                       const std::string& camera = "");

}  // namespace breakwater
