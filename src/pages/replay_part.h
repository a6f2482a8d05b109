// A replay as a part of a page.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/finished_run.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>

namespace breakwater {

/// The runs of a page in three dimensions, with the data of the scenario's shot list.
struct ReplayPart {
  PageData box;                    ///< a block
  std::string labels;              ///< the names of the runs, in one text
  std::optional<PageChart> chart;  ///< the lines of the shot list
  Window window;                   ///< the time window of the shot list for these runs
  bool is_whole = false;           ///< the window covers nearly the whole run
};

/// The replay of one to four runs of one scenario, for a page that also works without it. Charts
/// of its `group` show the same moment. A browser without WebGL shows a strip of pictures of each
/// run; it is drawn if the run's folder has none. `notes` gets a line for each missing part, or why
/// there is no replay: this program lacks the scenario, or the log is too short.
std::optional<ReplayPart> replay_of(const Catalogue& catalogue, std::span<const SavedRun> saved,
                                    const std::string& group, std::vector<std::string>& notes);

/// Data of the button that switches between the whole time axis and the window.
PageData window_data(const Window& window, const std::string& axis);

/// The page of `breakwater replay`.
std::string replay_page(ShownRuns runs, const std::string& camera, std::vector<std::string>& notes);

}  // namespace breakwater
