// The parts of a scenario on one axis: what the catalogue's estimators and controllers are told.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include <breakwater/control/step_reference.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/sensor_error.h>
#include <breakwater/rigs/loop_parts.h>
#include <breakwater/signals/axis_units.h>

namespace breakwater {

/// What may be known of an axis: not how it really is.
struct NominalAxis {
  StateSpace plant;       ///< continuous: position and velocity under a force, position measured
  double period_s = 0.0;  ///< T_s, of the samples
  double force_limit = std::numeric_limits<double>::infinity();  ///< of the drive
  SensorError sensor;                                            ///< as a data sheet would tell it
  double pulses_per_revolution = 0.0;  ///< b_reso, or counts per metre; 0: not quantised
  AxisUnits units;
  int joint = 0;   ///< which of a manipulator's it is, from 0 on ...
  int joints = 1;  ///< ... of how many
};

/// What a controller of an axis is to do.
struct AxisTask {
  NominalAxis axis;
  StepReference reference;                                ///< of the position
  Eigen::Vector2d start_state = Eigen::Vector2d::Zero();  ///< what to believe at first
  bool senses_true_state = false;  ///< samples are [measured position; position; velocity]
};

/// An estimator of an axis by its name: key observer.name.
struct AxisEstimatorKind : PartKind<DisturbanceEstimator, const NominalAxis&> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "estimator of an axis";
};

/// A controller of an axis by its name: key controller.name. It is given the estimator that was
/// chosen beside it. One that keeps it calls its reset() and, at each sample, its update(), before
/// it reads from it; one that has no use for it lets it go, and the run's metrics of estimates are
/// absent.
///
/// It gets samples whose first entry is the measured position, and writes one force.
struct AxisControllerKind
    : PartKind<Controller, const AxisTask&, std::shared_ptr<DisturbanceEstimator>> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "controller of an axis";
};

inline const NominalAxis& what_is_known(const AxisTask& task) {
  return task.axis;
}

using AxisLoop = ControlLoop<DisturbanceEstimator>;

/// Which estimator and which controller an axis has.
class AxisParts
    : public LoopParts<DisturbanceEstimator, AxisEstimatorKind, AxisControllerKind, AxisTask> {
 public:
  /// `standard_controller`: of files without the key controller.name; empty: it must be there.
  AxisParts(const Catalogue& catalogue, const std::string& standard_controller)
      : LoopParts(catalogue, "observer.name", "", standard_controller) {}
};

/// Breakwater's own.
std::vector<AxisEstimatorKind> axis_estimators();
std::vector<AxisControllerKind> axis_controllers();

}  // namespace breakwater
