// A replay as a part of a page.
#pragma once

#include <deque>
#include <kainjow/mustache.hpp>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/finished_run.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>

namespace breakwater {

/// The runs of a page in three dimensions, and what the scenario's shot list says about them.
struct ReplayPart {
  kainjow::mustache::data box;     ///< for data/report/replay_box.mustache
  std::optional<PageChart> chart;  ///< the shot list's lines
  ShotList shots;
  std::vector<Identity> identities;  ///< of the runs
  Window window;                     ///< the shot list's, of these runs
  bool is_whole = false;             ///< the window leaves next to nothing of them out
  std::vector<std::string> notes;    ///< what it could not show, one line each
};

struct ReplayOptions {
  std::string id;      ///< of the element
  std::string group;   ///< charts of this group show the same moment
  std::string camera;  ///< in place of the shot list's, unless empty
};

/// One to four runs of one scenario, with a label each. A browser that cannot draw in three
/// dimensions shows the first run's strip, which is drawn unless the run's folder has one. Throws
/// std::invalid_argument or RenderError.
ReplayPart replay_part(const std::deque<FinishedRun>& runs, const std::vector<std::string>& labels,
                       const ReplayOptions& options);

/// The same of runs' folders, as a part of a page that goes without it: where there is nothing to
/// show, since this program does not have the scenario, say, or the log is too short, a note says
/// why.
std::optional<ReplayPart> replay_of(const Catalogue& catalogue,
                                    const std::vector<std::filesystem::path>& folders,
                                    const std::vector<std::string>& labels,
                                    const ReplayOptions& options, std::vector<std::string>& notes);

/// For the button that shows all of an axis' time, and the window again.
kainjow::mustache::data window_data(const Window& window, const std::string& axis);

/// The page of `breakwater replay`.
std::string replay_page(const std::deque<FinishedRun>& runs, const std::vector<std::string>& labels,
                        const std::string& camera, std::vector<std::string>& notes);

/// The video of a run for the templates, if there is one in its folder; charts of `group`
/// move with it. It is taken for one of the shot list's window, as far as the run lasts.
std::optional<kainjow::mustache::data> video_data(const Catalogue& catalogue, const SavedRun& run,
                                                  const std::string& group);

}  // namespace breakwater
