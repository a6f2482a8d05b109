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

/// All of the longest run, at the speed of life.
Window whole_window(const std::deque<FinishedRun>& runs);

/// What a video of these runs shows: what is wished for, else the shot list's window as far as a
/// run lasts, or all of the longest run at the speed of life if it lasts no part of it. Throws
/// std::invalid_argument if the wish is outside of all runs.
Window choose_window(const std::deque<FinishedRun>& runs, const ShotList& shots, const Wish& wish);

/// When a moment of the shot list is in that run; nothing if it does not come.
std::optional<double> time_of(const ShotMoment& moment, const FinishedRun& run);

}  // namespace breakwater
