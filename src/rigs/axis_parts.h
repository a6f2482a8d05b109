// The interface between an axis, alone or one of a plant's, and its estimator and controller.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/control/estimating_control.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/disturbance_model.h>
#include <breakwater/observers/sensor_error.h>
#include <breakwater/plants/motor_and_load.h>
#include <breakwater/record/recording.h>
#include <breakwater/rigs/loop_parts.h>
#include <breakwater/signals/axis_units.h>

namespace breakwater {

/// The nominal model of an axis.
struct NominalAxis {
  StateSpace plant;  ///< continuous: the input is a force, the states are position and velocity
                     ///< (of two inertias, if E is there), the output is the position
  double period_s = 0.0;    ///< sampling period T_s
  bool is_sampled = false;  ///< the plant is that over a period; its disturbance is at the input
  double force_limit = std::numeric_limits<double>::infinity();  ///< limit of the drive
  SensorError sensor;                                            ///< as in a data sheet
  double pulses_per_revolution = 0.0;  ///< b_reso, or counts per metre; 0: not quantised
  AxisUnits units;
  int joint = 0;   ///< index in a manipulator, from 0 ...
  int joints = 1;  ///< ... and the manipulator's number of joints

  // With a transmission (drive_settings.h).
  Side measured = Side::load;
  double measured_ratio = 1.0;  ///< motion of the measured side for one of the load at rest
  std::optional<TwoInertia> inertias = {};  ///< the nominal numbers, if known
  std::string why_no_inertias = {};         ///< the key whose number is 0, if they are not
  /// If the plant has the states of both inertias (motor_and_load.h): ẋ = A x + B u − E d.
  /// Otherwise empty, and d opposes the input.
  Eigen::VectorXd E = {};
  Eigen::Index controlled = 0;  ///< the state that is the load's position
  double inertia = 0.0;         ///< d over the acceleration of the measured side; 0: 1/B₂

  /// The plant over an interval, with a model of the disturbance.
  ExtendedPlant extended(int order, double interval_s) const {
    if (is_sampled) return extend_by_disturbance_model(plant, order, interval_s);
    return sample_with_disturbance_model(plant, order, interval_s, E);
  }
};

/// The force of the tip in the samples of a controller.
struct ForceTask {
  /// The entry of the measured force [N], behind the sensor's low-pass. The one before the low-pass
  /// follows it. -1: the plant has no tip.
  Eigen::Index entry = -1;
  Reference reference;  ///< [N]

  bool is_there() const { return entry >= 0; }
};

/// The task of a controller of an axis.
struct AxisTask {
  NominalAxis axis;
  Reference reference;                                    ///< reference of the position
  Eigen::Vector2d start_state = Eigen::Vector2d::Zero();  ///< initial state of the estimator
  bool senses_true_state = false;  ///< samples are [measured position; position; velocity]
  ForceTask force = {};            ///< is behind them

  /// The reference of the measured side.
  Reference measured_reference() const {
    Reference measured = reference;
    measured.value *= axis.measured_ratio;
    measured.before *= axis.measured_ratio;
    for (double& value : measured.table.values) value *= axis.measured_ratio;
    return measured;
  }
  /// The reference that belongs to the nominal model: that of the load if the model has both
  /// inertias, otherwise that of the measured side.
  Reference modelled_reference() const {
    return axis.E.size() == 0 ? measured_reference() : reference;
  }
  /// The initial state of the whole plant: a second inertia moves with the first.
  Eigen::VectorXd start() const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(axis.plant.states());
    x.head<2>() = start_state;
    if (x.size() == 4) {
      const double ratio = axis.inertias->ratio;
      x.tail<2>() = start_state * (axis.measured == Side::motor ? 1.0 / ratio : ratio);
    }
    return x;
  }
  /// The loop of its controller. `has_poles`: the log has the estimator's poles.
  AxisLoopDesign loop(Reference followed, bool has_poles = true) const {
    return {std::move(followed), axis.force_limit, has_poles ? axis.period_s : 0.0, axis.units,
            start()};
  }
};

/// An estimator of an axis and its name: key observer.name.
struct AxisEstimatorKind : PartKind<DisturbanceEstimator, const NominalAxis&> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "estimator of an axis";
  static constexpr const char* kKey = "observer.name";
};

/// A controller of an axis and its name: key controller.name. It is given the chosen estimator. A
/// controller that keeps it calls its reset() and, at each sample, its update(), before it uses the
/// estimates. A controller that does not need it releases it, without metrics of estimates.
///
/// It gets samples whose first entry is the measured position, and writes one force.
struct AxisControllerKind
    : PartKind<Controller, const AxisTask&, std::shared_ptr<DisturbanceEstimator>> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "controller of an axis";
};

template <typename Make>
auto estimator_for(const AxisTask& task, Make&& make) {
  return make(task.axis);
}

using AxisLoop = ControlLoop<DisturbanceEstimator>;

/// The chosen estimator and controller of an axis.
using AxisParts = LoopParts<DisturbanceEstimator, AxisEstimatorKind, AxisControllerKind, AxisTask>;

/// The estimators of the thesis and QVFF, and those of others: library `published`.
std::vector<AxisEstimatorKind> axis_estimators();
std::vector<AxisEstimatorKind> published_estimators();
std::vector<AxisControllerKind> axis_controllers();

/// A number with which a controller ends a run: a metric, or a cost.
struct ControllerTotal {
  MetricDefinition definition;
  double value;
  bool is_cost = false;
};

/// The totals of predictive control's optimisations, zeros without a controller. Another controller
/// has none.
std::vector<ControllerTotal> qp_totals(const Controller* controller);

}  // namespace breakwater
