// Scenarios whose axes have loops of their own.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/catalogue.h>
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

/// A scenario of one axis: its name, its axis and its standard controller.
struct AxisScenarioDesign {
  std::string name;
  std::string summary;
  Axis axis;
  std::string controller = {};  ///< the default one; empty: the file names it
  bool optimises = false;       ///< the metrics of predictive control's optimisations belong to it
  std::vector<MetricKind> reductions = {};  ///< its own
};

/// A scenario of one axis. Its members are valid after its settings are read and checked.
///
/// Its metrics may be of every signal of the log, and of `reference_…` of the load. The estimates
/// position_hat_…, velocity_hat_… and d_hat_… are there for each controller with an estimator.
class AxisScenario : public LoopScenario {
 public:
  std::string name() const override { return design_.name; }
  std::string summary() const override { return design_.summary; }
  /// Binds the keys of the plant, of its controller and its estimator, then bind(), then the rows
  /// of the metrics.
  Fields fields() override;
  /// Also calls complete().
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  std::vector<MetricDefinition> metric_definitions() const override;
  std::vector<std::string> warnings() const override { return plant().warnings(); }
  std::vector<AxisOfPlant> loops() const final { return {{plant(), task(), &parts_}}; }
  Recording run(const RunControl& control) const override;

  /// The plant of this case.
  virtual AxisPlant plant() const { return plant_; }
  /// The task of its controller: the axis follows its reference.
  virtual AxisTask task() const;

 protected:
  AxisScenario(const Catalogue& catalogue, AxisScenarioDesign design);

  /// Binds the scenario's own keys.
  virtual void bind(Fields& fields) = 0;
  /// Reads and checks what only this scenario has, after the plant's settings. Returns the names
  /// for the rows of its metrics. Throws as check().
  virtual MetricContext complete(const Config& /*config*/) { return {}; }
  virtual AxisAdditions additions(const AxisRig& /*rig*/, const AxisLoop& /*loop*/) const {
    return {};
  }
  /// Binds task.reference_… and task.reference_from_s, a step of the reference from 0.
  void bind_step(Fields& fields);

  AxisPlant plant_;
  AxisParts parts_;

 private:
  AxisScenarioDesign design_;
};

/// The kind of a scenario with a constructor that takes the catalogue.
template <typename OneScenario>
ScenarioKind scenario_kind(const char* name) {
  return {name, [](const Catalogue& catalogue) -> std::unique_ptr<Scenario> {
            return std::make_unique<OneScenario>(catalogue);
          }};
}

}  // namespace breakwater
