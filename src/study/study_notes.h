// Notes on the results of a study that a user should know before drawing conclusions.
#pragma once

#include <string>
#include <vector>

#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// Whether two runs have the same states and metrics.
bool are_same_run(const PointResult& one, const PointResult& other);
/// What equal runs of several seeds mean.
inline constexpr const char* kNoNoise = "no noise reaches their motion or a metric";

/// The notes, one per line. They name metrics that some complete runs of a candidate lack, so that
/// its medians are over fewer runs. They also name seeds that change nothing.
std::vector<std::string> notes(const Plan& plan, const ShardIndex& index);

}  // namespace breakwater
