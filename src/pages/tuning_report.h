// The page about a tuning.
#pragma once

#include <filesystem>

#include <breakwater/search/tuner.h>
#include <breakwater/search/tuning_plan.h>

namespace breakwater {

/// Writes DIR/report.html: the Pareto fronts over the first two objectives, the hypervolume over
/// the budget, and each point of a front with its file. Throws OutputError.
void write_tuning_report(const Catalogue& catalogue, const TuningPlan& plan,
                         const TuningResult& result, const std::optional<Ranking>& ranking,
                         const std::filesystem::path& folder);

}  // namespace breakwater
