// The meaning of a metric, for the reference.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// The meaning of a metric, or of a cost, that a run may report.
struct MetricDefinition {
  std::string name;  ///< as the Metric has it
  std::string unit;  ///< as the Metric has it
  std::string text;  ///< one sentence without a full stop
};

}  // namespace breakwater
