// The Kalman filters with disturbance estimation, for designs of any size.
#pragma once

#include <memory>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/kalman_design.h>
#include <breakwater/observers/sensor_error.h>
#include <breakwater/observers/vfakfd.h>

namespace breakwater {

/// Kfd, Fakfd (`gamma`: diagonal of Γ), Vfakfd and Stf of a design. For one input, one output and
/// up to six extended states the sizes are fixed at compile time. This reduces the time to a
/// seventh (three states) or a half (five): docs/explanation/performance.md. Each throws as its
/// class does.
std::unique_ptr<DisturbanceEstimator> sized_kfd(const KalmanDesign& design);
std::unique_ptr<DisturbanceEstimator> sized_fakfd(const KalmanDesign& design,
                                                  const Eigen::VectorXd& gamma);
std::unique_ptr<DisturbanceEstimator> sized_vfakfd(const KalmanDesign& design,
                                                   const VfakfdDesign& adaptation);
std::unique_ptr<DisturbanceEstimator> sized_stf(const KalmanDesign& design,
                                                const SensorError& error);

}  // namespace breakwater
