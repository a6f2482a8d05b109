// From finished runs and a shot list to what pictures are drawn from.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/pictures/finished_run.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/render/picture.h>

namespace breakwater {

/// Reads from a run all that its pictures show. `camera` replaces the shot list's unless empty. The
/// run outlives it. With `missing`, arrows and lines of signals that the run's log does not have,
/// since they are another controller's, are left out, and their names go there. Throws
/// std::invalid_argument, one line.
PictureRun stage(const FinishedRun& run, const ShotList& shots, const std::string& camera,
                 std::vector<std::string>* missing = nullptr);

/// What was asked for, in place of the shot list's.
struct Wish {
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::optional<double> speed;
};

struct Window {
  double from_s = 0.0;
  double to_s = 0.0;
  double speed = 1.0;

  /// round((to − from)/speed·fps).
  std::size_t frames(int fps) const;
  /// The simulated time that frame k shows.
  double time_of(std::size_t k, int fps) const {
    return from_s + static_cast<double>(k) * speed / fps;
  }
};

/// Runs that are shown together.
using ShownRuns = std::vector<const FinishedRun*>;
ShownRuns pointers_to(const std::deque<FinishedRun>& runs);

/// Up to this many runs are shown together.
inline constexpr std::size_t kMostRuns = 4;

/// Finished runs to be shown together. Throws std::invalid_argument, one line, if they are too many
/// or of more than one scenario, or as FinishedRun.
std::deque<FinishedRun> open_runs(const Catalogue& catalogue,
                                  const std::vector<std::string>& folders);

/// The looks of runs that are shown together.
std::vector<Identity> identities_of(const Catalogue& catalogue, const std::vector<SavedRun>& runs);
/// The cases of a scenario, in its file's order; none where this program does not have it.
std::vector<std::string> cases_of(const Catalogue& catalogue, const std::string& scenario);

/// All of the longest run, at the speed of life.
Window whole_window(const ShownRuns& runs);

/// What a video of these runs shows: what is wished for, else the shot list's window as far as a
/// run lasts, or all of the longest run at the speed of life if it lasts no part of it. Throws
/// std::invalid_argument if the wish is outside of all runs.
Window choose_window(const ShownRuns& runs, const ShotList& shots, const Wish& wish);

/// Everything that pictures of some runs are drawn from.
struct PictureStage {
  std::vector<PictureRun> runs;
  PictureStyle style;              ///< of the shot list; its size and look are the caller's
  std::vector<std::string> notes;  ///< what a user should know, one line each
};
/// `camera` replaces the shot list's unless empty. The runs outlive it.
PictureStage stage_pictures(const ShownRuns& runs, const ShotList& shots, const std::string& camera,
                            const Window& window);

/// When a moment of the shot list is in that run; nothing if it does not come.
std::optional<double> time_of(const ShotMoment& moment, const FinishedRun& run);

}  // namespace breakwater
