// A reference that steps from 0.
#pragma once

namespace breakwater {

struct StepReference {
  double value = 0.0;
  double from_s = 0.0;

  double at(double time_s) const { return time_s >= from_s ? value : 0.0; }
};

}  // namespace breakwater
