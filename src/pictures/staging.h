// Prepares finished runs for pictures by a shot list.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <breakwater/pictures/finished_run.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/render/picture.h>
#include <breakwater/render/scene_view.h>

namespace breakwater {

/// The names of a signal's values: "torque_Nm[1]", … of a vector, else its own. Throws
/// std::invalid_argument if the run does not have it.
std::vector<std::string> value_names(const SavedRun& run, const std::string& signal);

/// Reads the data for a run's pictures. `camera`, if not empty, replaces that of the shot list. The
/// run must outlive the result. Arrows and lines may use signals that the log does not have, such
/// as those of another controller. With `notes` they are left out, and `notes` gets a line for
/// each. Throws std::invalid_argument, one line.
PictureRun stage(const FinishedRun& run, const ShotList& shots, const std::string& camera,
                 std::vector<std::string>* notes = nullptr);

/// The user's choices, which replace those of the shot list.
struct Wish {
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::optional<double> speed;
};

struct Window {
  double from_s = 0.0;
  double to_s = 0.0;
  double speed = 1.0;

  /// round((to − from)/speed·fps)
  std::size_t frames(int fps) const;
  /// The simulated time of frame k.
  double time_of(std::size_t k, int fps) const {
    return from_s + static_cast<double>(k) * speed / fps;
  }
};

/// Runs in one picture.
using ShownRuns = std::span<const FinishedRun>;

/// The largest number of runs in one picture.
inline constexpr std::size_t kMostRuns = 4;

/// Opens finished runs for one picture. Throws std::invalid_argument, one line, if there are too
/// many or of more than one scenario, or as FinishedRun.
std::vector<FinishedRun> open_runs(const Catalogue& catalogue,
                                   const std::vector<std::string>& folders);

/// The looks of runs that are shown together.
std::vector<LineStyle> styles_of(const Catalogue& catalogue, const std::vector<SavedRun>& runs);
/// The cases of a scenario, in its file's order; none where this program does not have it.
std::vector<std::string> cases_of(const Catalogue& catalogue, const std::string& scenario);

/// All whole longest run, in real time.
Window whole_window(ShownRuns runs);

/// The window of a video of these runs: the wish, or the window of the shot list up to the end of
/// the runs. If no run reaches that window, it is the whole longest run in real time. Throws
/// std::invalid_argument if the wish is outside of all runs.
Window choose_window(ShownRuns runs, const ShotList& shots, const Wish& wish);

/// The data for pictures of some runs.
struct PictureStage {
  std::vector<PictureRun> runs;    ///< captions are the labels of the runs
  std::vector<LineStyle> styles;   ///< the looks of the runs
  PictureStyle style;              ///< from the shot list; the caller sets size and look
  std::vector<std::string> notes;  ///< for the user, one line each
};
/// `camera`, if not empty, replaces that of the shot list. The runs must outlive the result.
PictureStage stage_pictures(ShownRuns runs, const ShotList& shots, const std::string& camera,
                            const Window& window);

/// The time of a moment of the shot list in a run; nothing if the run does not have it.
std::optional<double> time_of(const ShotMoment& moment, const FinishedRun& run);

struct Moment {
  std::string caption;
  double time_s;
};
/// The shot list's moments that are in the run. `missing` gets the reasons why others are not.
std::vector<Moment> moments_of(const FinishedRun& run, const ShotList& shots,
                               std::vector<std::string>* missing = nullptr);

/// Draws pictures in a row, each with a letter, its caption and its time below. A chart of the
/// whole width has marks at the moments. `each` has the size and look of a picture, `camera` and
/// `notes` are as in stage(). Returns a PNG file. Throws RenderError.
std::string draw_strip(const FinishedRun& run, const ShotList& shots,
                       const std::vector<Moment>& moments, const std::string& camera,
                       const PictureStyle& each, std::vector<std::string>* notes = nullptr);

}  // namespace breakwater
