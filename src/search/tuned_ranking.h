// The ranking of the tuned cases of one objective.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/search/tuner.h>
#include <breakwater/search/tuning_plan.h>
#include <breakwater/statistics/ranking.h>

namespace breakwater {

/// Ranks the best candidates of the cases by the objective's metric in the test conditions of the
/// validation. Each condition is a block. Nothing with several objectives, without a validation, or
/// for fewer than two cases with a feasible candidate.
std::optional<Ranking> rank_tuned(const TuningPlan& plan, const TuningResult& result);

/// The cases with a feasible candidate in the order of the ranking, or of the tuned objective.
std::vector<std::size_t> tuned_order(const Tuning& tuning, const TuningResult& result,
                                     const std::optional<Ranking>& ranking);

/// The searched keys of a case whose values are in the outer hundredths of their ranges, or are the
/// smallest or largest of their numbers. A better value may lie beyond.
std::vector<std::string> keys_at_bound(const TunedCase& tuned,
                                       const std::vector<std::string>& values);

}  // namespace breakwater
