// Previews of a study, from a few runs or from those that are done.
#pragma once

#include <cstddef>
#include <string>

#include <breakwater/study/study_comparison.h>
#include <breakwater/study/sweep.h>

namespace breakwater {

/// Prints the number of runs and their time on `jobs` cores (0: all), estimated from one run of
/// each candidate. Also prints their warnings. Throws Interrupted.
void print_preview(const Sweep& sweep, std::size_t jobs);

/// Looks for misspelt names of metrics before the study runs. For names that the scenario does not
/// define it makes a first and a last run of each candidate. Throws std::invalid_argument.
void check_names(const Sweep& sweep);

/// Why the runs lack a metric, behind "no run has it": they are too short, or it is misspelt.
std::string why_missing(const Sweep& sweep, const UnknownMetric& metric);

/// A text such as "3 of 40 points are done; of these 1 failed".
std::string counted(const ShardIndex& index);

/// Estimated processor time of the undone points: for each, the mean of its candidate.
double time_to_go_s(const Plan& plan, const ShardIndex& index);

}  // namespace breakwater
