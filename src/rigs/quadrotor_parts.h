// The interface between a scenario with the quadrotor and its estimators and controllers.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/plants/quadrotor.h>
#include <breakwater/rigs/loop_parts.h>
#include <breakwater/sim/underwater_force.h>

namespace breakwater {

/// The task and the nominal model of the quadrotor.
struct QuadrotorTask {
  QuadrotorModel plant;
  double period_s = 0.0;  ///< sampling period T_s
  Eigen::Vector3d reference_m = Eigen::Vector3d::Zero();
  double position_std_m = 0.0;  ///< from the measurement noise
  double angle_std_rad = 0.0;
  double position_noise = 0.0;  ///< V_m and V_p as given, before their interpretation
  double angle_noise = 0.0;
  /// The waves. Estimators know the sea's shape alone; only a forecast that is told more may read
  /// the rest.
  WaveLoadSetup waves;
};

template <typename Make>
auto estimator_for(const QuadrotorTask& task, Make&& make) {
  return make(task);
}

/// An estimator of the quadrotor and its name: key estimator.name.
struct QuadrotorEstimatorKind : PartKind<QuadrotorEstimator, const QuadrotorTask&> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "estimator of the quadrotor";
  static constexpr const char* kKey = "estimator.name";
};

/// A controller of the quadrotor and its name: key controller.name. It gets the estimator as an
/// AxisControllerKind. It gets samples [x y z φ θ ψ] [m, rad] and writes four thrusts [N].
struct QuadrotorControllerKind
    : PartKind<Controller, const QuadrotorTask&, std::shared_ptr<QuadrotorEstimator>> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "controller of the quadrotor";
};

using QuadrotorLoop = ControlLoop<QuadrotorEstimator>;

/// The chosen estimator and controller of the quadrotor.
using QuadrotorParts =
    LoopParts<QuadrotorEstimator, QuadrotorEstimatorKind, QuadrotorControllerKind, QuadrotorTask>;

/// The estimators and controllers of Breakwater.
std::vector<QuadrotorEstimatorKind> quadrotor_estimators();
std::vector<QuadrotorControllerKind> quadrotor_controllers();

/// A vehicle goes to a point under waves and stays there. The controller uses the state of one of
/// several nonlinear estimators. The model must have a free body "quadrotor" with the sites t1 …
/// t4, four thrusters and the sensors position and attitude.
ScenarioKind quadrotor_kind(const std::string& name, const std::string& summary);

}  // namespace breakwater
