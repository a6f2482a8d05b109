// The few metrics that say most, where there is no room for all.
#pragma once

#include <string>
#include <vector>

#include <breakwater/record/recording.h>

namespace breakwater {

/// Those of `metrics` that `names` (Scenario::main_metrics) names, in its order; the first two if
/// it names none.
std::vector<Metric> main_metrics(const std::vector<std::string>& names,
                                 const std::vector<Metric>& metrics);

/// "free_motion_time_s 0.5302  peak_force_filtered_N 2.317".
std::string brief(const std::vector<Metric>& metrics);

}  // namespace breakwater
