// Scenarios whose axes have loops of their own.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
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

 protected:
  LoopScenario() = default;
  explicit LoopScenario(MetricRows rows) : Scenario(std::move(rows)) {}
};

/// The further signals of a scenario's run. The functions own the values of the signals.
struct AxisAdditions {
  std::vector<Signal> logged = {};
  std::vector<Signal> unlogged = {};               ///< for metrics alone
  std::function<void()> step = {};                 ///< is called after each physics step
  std::function<void(double time_s)> sample = {};  ///< is called after each sample
};

/// A scenario of one axis. Valid after its settings are read and checked.
///
/// Its metrics may be of every signal of the log, and of `reference_…` of the load. The estimates
/// position_hat_…, velocity_hat_… and d_hat_… are there for each controller with an estimator.
class AxisScenario : public LoopScenario {
 public:
  /// The plant of this case.
  virtual AxisPlant plant() const = 0;
  /// The task of its controller.
  virtual AxisTask task() const = 0;
  /// The choice of its estimator and controller.
  virtual const AxisParts& parts() const = 0;

  std::vector<MetricDefinition> metric_definitions() const override;
  std::vector<std::string> warnings() const override { return plant().warnings(); }
  std::vector<AxisOfPlant> loops() const final { return {{plant(), task(), &parts()}}; }
  Recording run(const RunControl& control) const override;

 protected:
  enum class Optimises { no, yes };

  AxisScenario() = default;

  /// With Optimises::yes the metrics of predictive control's optimisations belong to it.
  AxisScenario(const Catalogue& catalogue, const std::string& name,
               Optimises optimises = Optimises::no)
      : LoopScenario(MetricRows(catalogue, name)), optimises_(optimises) {}
  AxisScenario(MetricRows rows, Optimises optimises)
      : LoopScenario(std::move(rows)), optimises_(optimises) {}

  void check_metrics(const Config& config, const MetricContext& context = {});
  virtual AxisAdditions additions(const AxisRig& /*rig*/, const AxisLoop& /*loop*/) const {
    return {};
  }

 private:
  Optimises optimises_ = Optimises::no;
};

}  // namespace breakwater
