// The signals of a run as charts, the most important first.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/shot_list.h>

namespace breakwater {

/// Signals of one width and unit. They differ by their roles in a their kind: true,
/// measured, estimated, reference, commanded or applied. One that two groups have is here once,
/// from the group with more rows.
struct LoggedQuantity {
  std::string title;  ///< "Contact force", without its unit
  std::vector<LogEntry> kinds;
  std::size_t rank = 0;
};

/// All quantities of a log. First come those of the shot list in its order, then those of several
/// kinds, then the others.
std::vector<LoggedQuantity> quantities(const std::vector<LogEntry>& signals, const ShotList& shots);

/// "physics/force_true_N"; a signal of the group `control` goes without "force_true_N".
std::string signal_path(const LogEntry& entry);

/// A signal of a run, or one of its values: "torque_Nm[2]".
ChartSeries series_of(const SavedRun& run, const std::string& signal, const std::string& label);

struct SignalCharts {
  std::vector<PageChart> key;  ///< the shot list's page has them, or they are the first quantities
  std::vector<PageChart> others;       ///< one for each other quantity. A vector of several values
  std::vector<std::string> constants;  ///< "saturated = 0": signals that no chart shows
};

/// No signal is in two charts, and no chart has two units.
SignalCharts signal_charts(const SavedRun& run, const std::string& id, const ShotList& shots);

}  // namespace breakwater
