// The signals of a run as charts, the most important first.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/shot_list.h>

namespace breakwater {

/// A signal of a run, or one of its values: "torque_Nm[2]".
ChartSeries series_of(const SavedRun& run, const std::string& signal, const std::string& label);

struct SignalCharts {
  std::vector<PageChart> key;  ///< the shot list's page has them, or they are the first quantities
  std::vector<PageChart> others;  ///< one for each other quantity. A vector of several values
};

/// No signal is in two charts, none that is constant in any, and no chart has two units.
SignalCharts signal_charts(const SavedRun& run, const std::string& id, const ShotList& shots);

}  // namespace breakwater
