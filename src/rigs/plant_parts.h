// The interface between a plant with named axes and the controllers of all its axes.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/axis_settings.h>

namespace breakwater {

/// The task of a controller of all axes.
struct PlantTask {
  std::vector<std::string> names;  ///< names of the axes
  std::vector<AxisTask> axes;
  std::vector<std::size_t> driven;  ///< the axes whose forces the controller commands
  /// The plant linearised about its pose, as one axis with many states. The inputs are the driven
  /// axes, the outputs all axes, and x = [deviations of all joints; their rates]. It has no states
  /// if it cannot be linearised, and `why_not_linear` then says why. The springs of the
  /// transmissions are part of it, without backlash and kinematic error.
  NominalAxis whole;
  std::string why_not_linear;
  Eigen::MatrixXd to_states;   ///< the state at rest at given deviations of the outputs
  Eigen::VectorXd pose;        ///< the axes' measured positions there
  Eigen::VectorXd held_input;  ///< the forces that hold it there
  Eigen::VectorXd limit;       ///< force limits of the driven axes
  bool senses_true_state = false;
  ForceTask force;
  /// Makes the controllers that the axes have chosen, as one.
  std::function<std::unique_ptr<Controller>()> own_controllers;
};

/// The task of a plant whose settings are complete, without own_controllers.
PlantTask plant_task(const AxisPlant& plant);

/// A controller of all axes and its name: key controller.name. It gets the samples of
/// AxisPlant::sensing(), and writes a force for each driven axis.
struct PlantControllerKind
    : PartKind<Controller, const PlantTask&, std::shared_ptr<DisturbanceEstimator>> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "controller of a plant";
};

inline const NominalAxis& what_is_known(const PlantTask& task) {
  return task.whole;
}

/// The chosen controller of a plant and its estimator of the linearised plant.
class PlantParts
    : public LoopParts<DisturbanceEstimator, AxisEstimatorKind, PlantControllerKind, PlantTask> {
 public:
  explicit PlantParts(const Catalogue& catalogue)
      : LoopParts(catalogue, "observer.name", "none", "axes") {}
};

/// Breakwater's controllers of a plant.
std::vector<PlantControllerKind> plant_controllers();

/// The catalogue with "none" among the estimators and the controllers of an axis, and "model" among
/// the contact laws.
Catalogue with_none(Catalogue catalogue);

}  // namespace breakwater
