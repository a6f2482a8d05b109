// A reference that steps from 0.
#pragma once

#include <limits>

namespace breakwater {

struct StepReference {
  double value = 0.0;
  double from_s = 0.0;
  double reversed_from_s = std::numeric_limits<double>::infinity();  ///< −value from then on

  double at(double time_s) const {
    if (time_s >= reversed_from_s) return -value;
    return time_s >= from_s ? value : 0.0;
  }
};

}  // namespace breakwater
