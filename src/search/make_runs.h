// A tuning's runs on this machine.
#pragma once

#include <cstddef>
#include <vector>

#include <breakwater/search/tuning_plan.h>
#include <breakwater/study/executor.h>
#include <breakwater/study/study_folder.h>

namespace breakwater {

/// run_points() into a shard of its own; with `isolate` run_isolated(), each process of which is
/// told its candidates. Returns whether all were made, or it was interrupted. Throws OutputError if
/// runs were left undone for another reason: their processes were killed from outside.
bool make_runs(const TuningPlan& plan, const StudyFolder& folder, std::vector<std::size_t> runs,
               bool isolate, ExecutorOptions options);

}  // namespace breakwater
