// Ranks of a sample.
#pragma once

#include <vector>

namespace breakwater {

/// The rank of each value, 1 for the smallest; equal values share the mean of their ranks.
std::vector<double> mid_ranks(const std::vector<double>& values);

}  // namespace breakwater
