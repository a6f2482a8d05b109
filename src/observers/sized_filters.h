// The Kalman filters with disturbance estimation, of whatever sizes a design has.
#pragma once

#include <memory>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/kalman_design.h>
#include <breakwater/observers/sensor_error.h>
#include <breakwater/observers/vfakfd.h>

namespace breakwater {

/// Kfd, Fakfd (Γ's diagonal `gamma`), Vfakfd and Stf of a design. One input, one output and up to
/// six extended states have sizes that are fixed when it is compiled: they take a seventh (three
/// states) to a half (five) of the time (docs/explanation/performance.md). Each throws as its class
/// does.
std::unique_ptr<DisturbanceEstimator> sized_kfd(const KalmanDesign& design);
std::unique_ptr<DisturbanceEstimator> sized_fakfd(const KalmanDesign& design,
                                                  const Eigen::VectorXd& gamma);
std::unique_ptr<DisturbanceEstimator> sized_vfakfd(const KalmanDesign& design,
                                                   const VfakfdDesign& adaptation);
std::unique_ptr<DisturbanceEstimator> sized_stf(const KalmanDesign& design,
                                                const SensorError& error);

}  // namespace breakwater
