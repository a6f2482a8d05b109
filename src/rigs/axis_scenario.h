// Scenarios of a plant of axes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/axis_rig.h>
#include <breakwater/rigs/plant_parts.h>

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

/// The name of a scenario of axes, and what its file need not say.
struct AxisScenarioDesign {
  std::string name;
  std::string summary;
  std::optional<Axis> axis = {};  ///< an axis of every file, the only one if it has no name
  std::string controller = {};    ///< the default one of its only axis; empty: the file names it
  /// Its controllers are those of an arm, and it has rows of its own. Its file has model.urdf, and
  /// its model the keyframe home and the sensors tip_force, tip_touch and tip_vel.
  bool is_arm = false;
  /// The default kind of the only axis' disturbance.
  DisturbanceKind disturbance = DisturbanceKind::none;
  /// The totals of its controllers, for a scenario with predictive control. Others do not link it.
  std::vector<ControllerTotal> (*totals)(const Controller* controller) = nullptr;
  std::vector<MetricKind> reductions = {};  ///< its own

  bool has_nameless_axis() const { return axis && axis->name.empty(); }
};

/// A scenario of a plant of axes. The file names the axes ([axis.NAME]), the forces on bodies
/// ([push.NAME]), the contacts ([contact.NAME]), the force sensor ([tip]) and the metrics
/// ([metric.NAME]). Each axis has its own reference, disturbance, estimator and controller, or one
/// controller drives all axes. Or there is one axis without a name, whose keys have no prefix. Its
/// members are valid after its settings are read and checked.
///
/// Its metrics may be of every signal of the log. An axis without a name also has `reference_…`,
/// and position_hat_…, velocity_hat_… and d_hat_… for each controller with an estimator.
class AxisScenario : public Scenario {
 public:
  AxisScenario(const Catalogue& catalogue, AxisScenarioDesign design);

  std::string name() const override { return design_.name; }
  std::string summary() const override { return design_.summary; }
  void learn(const Config& config) override;
  /// Binds the keys of the plant, of its controllers and its estimators, then bind(), then the rows
  /// of the metrics.
  Fields fields() override;
  /// Also calls complete().
  void check(const Config& config, const Fields& fields) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  std::vector<MetricDefinition> metric_definitions() const override;
  std::vector<std::string> warnings() const override { return warnings_; }
  Recording run(const RunControl& control) const override;
  void prepare_model(Model& model) const override {
    for (const ContactSettings& one : plant_.contacts) one.prepare(model);
  }

  /// The driven axes that have a controller, for `analyze`. Several axes hold the pose of
  /// start.keyframe. Valid while the scenario lives. Throws std::invalid_argument if an axis has no
  /// controller of its own.
  std::vector<AxisOfPlant> loops() const;

  /// The plant of this case.
  virtual AxisPlant plant() const { return plant_; }
  /// The task of the controller of the only axis, which follows its reference.
  AxisTask task() const;

 protected:
  /// Binds the scenario's own keys.
  virtual void bind(Fields& /*fields*/) {}
  /// Reads and checks what only this scenario has, after the plant's settings. Returns the names
  /// for the rows of its metrics. Throws as check().
  virtual MetricContext complete(const Config& /*config*/) { return {}; }
  /// Adds signals and more to a run.
  virtual void extend(RigRun& /*run*/, AxisRig& /*rig*/, const AxisLoop& /*loop*/) const {}
  /// The tip for an arm's controllers. Throws as tip_setup().
  virtual ArmSetup tip() const { return tip_setup(plant_); }
  /// The parts of the only axis.
  const AxisParts& parts() const { return axis_parts_.front(); }

 private:
  PlantTask whole_task() const;
  AxisLoop make_loop(const PlantTask& task) const;
  /// Whether the chosen controller is one of an arm, for the tip.
  bool moves_tip() const {
    return catalogue_.get<PlantControllerKind>(whole_->controller_name()).moves_tip;
  }
  /// Checks a plant of named axes, and returns its task.
  PlantTask check_whole(const Config& config);
  void warn_of_missing_signals(const Config& config, const PlantTask& task);
  RigRun make_run(AxisRig& rig, const AxisLoop& loop) const;
  /// Whether the axis has a controller of its own.
  bool has_own_loop(std::size_t i) const;
  /// The axes' own controllers, with `other` at the axis `replaced` if it is there.
  std::unique_ptr<Controller> axes_control(const std::vector<AxisTask>& tasks,
                                           std::unique_ptr<Controller> other = nullptr,
                                           std::size_t replaced = 0) const;

  AxisScenarioDesign design_;
  Catalogue catalogue_;  // only with named axes

 protected:
  AxisPlant plant_;
  Eigen::Vector2d start_estimate_ = Eigen::Vector2d::Zero();  ///< that of the only axis

 private:
  std::vector<AxisParts> axis_parts_;  // in the order of the axes
  std::optional<PlantParts> whole_;    // only with named axes
  std::vector<std::string> warnings_;
};

/// A scenario that is a file alone.
inline ScenarioKind axis_kind(const AxisScenarioDesign& design) {
  return scenario_kind<AxisScenario>(design.name, true, design);
}

}  // namespace breakwater
