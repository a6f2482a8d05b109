// A run's signals as charts, what matters first.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/shot_list.h>

namespace breakwater {

/// Signals of one group, width and unit whose names differ by what they are of a quantity alone:
/// true, measured, estimated, a reference, commanded, applied.
struct LoggedQuantity {
  std::string title;  ///< "contact force", without its unit
  std::vector<LogEntry> kinds;
  std::size_t rank = 0;
};

/// All quantities of a log. First those that a shot list shows, in its order; then those of which
/// there are several kinds; then the others, and last what another group than `control` has.
std::vector<LoggedQuantity> quantities(const std::vector<LogEntry>& signals, const ShotList& shots);

/// "force true" of "force_true_N": a signal's name without its unit, as people write it.
std::string readable_name(const std::string& signal, const std::string& unit);

/// One chart for each quantity, or for each of its values where there are several of several kinds.
std::vector<PageChart> signal_charts(const SavedRun& run, const std::string& id,
                                     const ShotList& shots);

}  // namespace breakwater
