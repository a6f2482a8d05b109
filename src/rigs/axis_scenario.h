// Scenarios whose axes have loops of their own.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/axis_rig.h>

namespace breakwater {

/// One axis of a plant, with the parts of its loop.
struct AxisOfPlant {
  AxisPlant plant;
  AxisTask task;           ///< the task of its controller
  const AxisParts* parts;  ///< the choice of its estimator and controller
  std::size_t index = 0;   ///< in the plant
  /// The controllers of all axes, with the given one at this axis. Empty for a plant with one axis.
  std::function<std::unique_ptr<Controller>(std::unique_ptr<Controller>)> among_others = {};

  const AxisSettings& settings() const { return plant.axes[index]; }
};

/// A scenario that describes the loops of its axes, so that `analyze` can build and probe them.
class LoopScenario : public Scenario {
 public:
  /// The driven axes that have a controller. Valid after the settings are read and checked, and
  /// while the scenario lives. Throws std::invalid_argument if an axis has no controller of its
  /// own.
  virtual std::vector<AxisOfPlant> loops() const = 0;
};

/// A scenario of one axis. Valid after its settings are read and checked.
class AxisScenario : public LoopScenario {
 public:
  /// The plant of this case.
  virtual AxisPlant plant() const = 0;
  /// The task of its controller.
  virtual AxisTask task() const = 0;
  /// The choice of its estimator and controller.
  virtual const AxisParts& parts() const = 0;

  std::vector<std::string> warnings() const override { return plant().warnings(); }
  std::vector<AxisOfPlant> loops() const final { return {{plant(), task(), &parts()}}; }
};

}  // namespace breakwater
