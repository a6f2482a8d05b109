// The most important metrics, for places without room for all.
#pragma once

#include <string>
#include <vector>

#include <breakwater/record/recording.h>

namespace breakwater {

/// The `metrics` with these `names` (Scenario::main_metrics), in that order. If empty, the first
/// two.
std::vector<Metric> main_metrics(const std::vector<std::string>& names,
                                 const std::vector<Metric>& metrics);

/// "free_motion_time_s 0.5302  peak_force_filtered_N 2.317".
std::string brief(const std::vector<Metric>& metrics);

}  // namespace breakwater
