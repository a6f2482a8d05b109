// A tuning's runs on this machine.
#pragma once

#include <cstddef>
#include <vector>

#include <breakwater/study/executor.h>
#include <breakwater/study/study_folder.h>
#include <breakwater/tuning/tuning_plan.h>

namespace breakwater {

/// run_points(); with `isolate` run_isolated(), each process of which is told its candidates.
std::size_t make_runs(const TuningPlan& plan, const StudyFolder& folder,
                      std::vector<std::size_t> runs, bool isolate, Shard& shard,
                      const ExecutorOptions& options);

}  // namespace breakwater
