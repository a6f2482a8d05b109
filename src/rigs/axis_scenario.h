// A scenario whose plant is one axis.
#pragma once

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/axis_rig.h>

namespace breakwater {

/// A scenario of one axis that describes its loop, so that `analyze` can build and probe it. Valid
/// after its settings are read and checked.
class AxisScenario : public Scenario {
 public:
  /// The plant of this case.
  virtual AxisPlant plant() const = 0;
  /// The task of its controller.
  virtual AxisTask task() const = 0;
  /// The choice of its estimator and controller.
  virtual const AxisParts& parts() const = 0;
};

}  // namespace breakwater
