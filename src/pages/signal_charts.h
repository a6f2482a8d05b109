// The signals of a run as charts, the most important first.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/shot_list.h>

namespace breakwater {

/// Signals of one quantity in one group, with equal width and unit. They differ in their kind:
/// true, measured, estimated, reference, commanded or applied.
struct LoggedQuantity {
  std::string title;  ///< "contact force", without its unit
  std::vector<LogEntry> kinds;
  std::size_t rank = 0;
};

/// All quantities of a log. First come those of the shot list in its order, then those of several
/// kinds, then the others, last those of other groups than `control`.
std::vector<LoggedQuantity> quantities(const std::vector<LogEntry>& signals, const ShotList& shots);

/// The name of a signal without its unit: "force true" for "force_true_N".
std::string readable_name(const std::string& signal, const std::string& unit);

/// One chart for each quantity. A vector of several kinds has one chart for each of its values.
std::vector<PageChart> signal_charts(const SavedRun& run, const std::string& id,
                                     const ShotList& shots);

}  // namespace breakwater
