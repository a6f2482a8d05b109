// Confidence intervals.
#pragma once

#include <cstdint>

namespace breakwater {

struct ConfidenceInterval {
  double lower;
  double upper;
};

/// Settings of bootstrap intervals, which resample with replacement.
struct BootstrapSettings {
  int replicates = 1000;
  double level = 0.95;     ///< coverage of the intervals
  std::uint64_t seed = 1;  ///< random seed of the draws
};

}  // namespace breakwater
