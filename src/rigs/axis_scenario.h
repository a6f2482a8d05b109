// A scenario whose plant is one axis.
#pragma once

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/axis_rig.h>

namespace breakwater {

/// A scenario of one axis tells of what its loop is made, so that the loop can be taken out of it
/// and probed: `analyze` does. Valid once its settings are read and checked.
class AxisScenario : public Scenario {
 public:
  /// The plant as this case has it.
  virtual AxisSettings plant() const = 0;
  /// What its controller is to do.
  virtual AxisTask task() const = 0;
  /// Which estimator and controller it has.
  virtual const AxisParts& parts() const = 0;
};

}  // namespace breakwater
