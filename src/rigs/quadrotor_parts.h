// The parts of a scenario with the quadrotor: what the catalogue's estimators and controllers are
// told.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/plants/quadrotor.h>
#include <breakwater/rigs/loop_parts.h>
#include <breakwater/world/jonswap.h>

namespace breakwater {

/// What an estimator and a controller of the quadrotor are told.
struct QuadrotorTask {
  QuadrotorModel plant;
  double period_s = 0.0;  ///< T_s, of the samples
  Eigen::Vector3d reference_m = Eigen::Vector3d::Zero();
  double position_std_m = 0.0;  ///< of the measurement's noise
  double angle_std_rad = 0.0;
  double position_noise = 0.0;  ///< V_m and V_p as they are given, whatever they are taken for
  double angle_noise = 0.0;
  SeaState sea;  ///< that is to be expected
};

inline const QuadrotorTask& what_is_known(const QuadrotorTask& task) {
  return task;
}

/// An estimator of the quadrotor by its name: key estimator.name.
struct QuadrotorEstimatorKind : PartKind<QuadrotorEstimator, const QuadrotorTask&> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "estimator of the quadrotor";
};

/// A controller of the quadrotor by its name: key controller.name. It is given the estimator that
/// was chosen beside it, as AxisControllerKind is. It gets samples [x y z φ θ ψ] [m, rad] and
/// writes four thrusts [N].
struct QuadrotorControllerKind
    : PartKind<Controller, const QuadrotorTask&, std::shared_ptr<QuadrotorEstimator>> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "controller of the quadrotor";
};

using QuadrotorLoop = ControlLoop<QuadrotorEstimator>;

/// Which estimator and which controller the quadrotor has.
class QuadrotorParts : public LoopParts<QuadrotorEstimator, QuadrotorEstimatorKind,
                                        QuadrotorControllerKind, QuadrotorTask> {
 public:
  explicit QuadrotorParts(const Catalogue& catalogue)
      : LoopParts(catalogue, "estimator.name", "kalman", "backstepping") {}
};

/// Breakwater's own.
std::vector<QuadrotorEstimatorKind> quadrotor_estimators();
std::vector<QuadrotorControllerKind> quadrotor_controllers();

}  // namespace breakwater
