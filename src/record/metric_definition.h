// The meaning of a metric, for the reference.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// The meaning of a metric or a cost.
struct MetricDefinition {
  std::string name;  ///< as in the Metric
  std::string unit;  ///< as in the Metric
  std::string text;  ///< one sentence without a full stop
};

}  // namespace breakwater
