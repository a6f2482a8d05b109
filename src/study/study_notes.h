// What a user should know of a study's results before drawing conclusions.
#pragma once

#include <string>
#include <vector>

#include <breakwater/study/plan.h>
#include <breakwater/study/shards.h>

namespace breakwater {

/// A line each: metrics that some complete runs of a candidate lack, so that its medians are over
/// other runs; seeds that change nothing.
std::vector<std::string> notes(const Plan& plan, const ShardIndex& index);

}  // namespace breakwater
