// The interface between a plant with named axes and the controllers of all its axes, those of an
// arm for its tip among them.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/observers/stacked_estimator.h>
#include <breakwater/rigs/arm_parts.h>
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
  ForceTask force;
  /// The estimator stands for each axis by itself, and not for the linearised plant.
  bool observes_axes = false;
  /// Finds the tip. Throws as tip_setup().
  std::function<ArmSetup()> tip;
  /// Makes the controllers that the axes have chosen, as one.
  std::function<std::unique_ptr<Controller>()> own_controllers;
};

/// The task of a plant whose settings are complete, without tip and own_controllers, and without
/// the linearised plant unless `is_linear`.
PlantTask plant_task(const AxisPlant& plant, bool is_linear = true);

/// A controller of all axes and its name: key controller.name. It gets the samples of
/// AxisPlant::sensing(), and writes a force for each driven axis.
struct PlantControllerKind
    : PartKind<Controller, const PlantTask&, std::shared_ptr<DisturbanceEstimator>> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "controller of a plant";

  bool moves_tip = false;  ///< it is one of an arm, and has an estimator for each axis
};

/// The estimator of the linearised plant, or one for each axis, by `make(NominalAxis)`.
template <typename Make>
std::shared_ptr<DisturbanceEstimator> estimator_for(const PlantTask& task, Make&& make) {
  if (!task.observes_axes) return make(task.whole);
  std::vector<std::unique_ptr<DisturbanceEstimator>> estimators;
  for (const AxisTask& one : task.axes) {
    NominalAxis axis = one.axis;
    axis.joint = static_cast<int>(estimators.size());
    axis.joints = static_cast<int>(task.axes.size());
    estimators.push_back(make(axis));
  }
  return std::make_shared<StackedEstimator>(std::move(estimators));
}

/// The chosen controller of a plant and its estimator of the linearised plant.
using PlantParts =
    LoopParts<DisturbanceEstimator, AxisEstimatorKind, PlantControllerKind, PlantTask>;

/// Commands nothing.
class NoControl final : public Controller {
 public:
  void reset(const Sample& /*first*/) override {}
  void update(const Sample& /*y*/, Eigen::Ref<Eigen::VectorXd> u) override { u.setZero(); }
};

/// Breakwater's controllers of a plant.
std::vector<PlantControllerKind> plant_controllers();

/// The catalogue with "none" among the estimators and the controllers of an axis, and "model" among
/// the contact laws. An arm's controllers are controllers of a plant too, and the only ones of an
/// arm. Their estimator stands for each joint by itself, with the nominal inertia of the joint's
/// axis.
Catalogue with_none(Catalogue catalogue, bool is_arm = false);

/// The kinematics of a plant's tip with the nominal inertias and the lag of its force. Without a
/// URDF it also has the nominal mass matrix at the start, and the wall. The tip is the site
/// of tip.sensor, or the centre of the geom that touches. The contact frame is that of the plane in
/// tip.contact: x is opposite to the plane's normal. Each joint from the world to the tip must have
/// an axis with an actuator and a sensor at the joint. There must be no other axis. Throws
/// std::invalid_argument.
ArmSetup tip_setup(const AxisPlant& plant);

}  // namespace breakwater
