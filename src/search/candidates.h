// Candidates as lines of text, for processes that run them and do not search.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <breakwater/search/tuning_plan.h>

namespace breakwater {

/// A line for each candidate of the runs: the number of its case, its own, and its keys' values as
/// TOML, which has no bare tab or end of a line in them.
std::vector<std::string> candidate_lines(const TuningPlan& plan,
                                         const std::vector<std::size_t>& runs);

/// Tells a plan the candidates of these lines. Throws std::invalid_argument `ORIGIN: reason`.
void begin_candidates(TuningPlan& plan, const std::vector<std::string>& lines,
                      const std::string& origin);

}  // namespace breakwater
