// Intervals of what is estimated from a sample.
#pragma once

#include <cstdint>

namespace breakwater {

struct ConfidenceInterval {
  double lower;
  double upper;
};

/// Of intervals that come from samples that are drawn again, with replacement.
struct BootstrapSettings {
  int replicates = 1000;
  double level = 0.95;     ///< of the intervals
  std::uint64_t seed = 1;  ///< of the draws
};

}  // namespace breakwater
