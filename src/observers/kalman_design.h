// Design parameters of the Kalman filters with disturbance estimation.
#pragma once

#include <breakwater/observers/disturbance_model.h>

namespace breakwater {

/// The estimates depend on the ratios of Q, R and P0 alone.
struct KalmanDesign {
  ExtendedPlant plant;
  Eigen::MatrixXd Q;   ///< N×N: covariance of the process noise in one sample
  Eigen::MatrixXd R;   ///< p×p: covariance of the measurement noise (Eq. 3.6)
  Eigen::MatrixXd P0;  ///< N×N: P(0|−1), the covariance before the first measurement
};

/// Throws std::invalid_argument unless the shapes fit, Q is symmetric positive semidefinite, and R
/// and P0 are symmetric positive definite. No value may be above 1e100.
void check(const KalmanDesign& design);

/// The process noise of the KFD. It enters like the input: Q = B̅ q B̅ᵀ (Eqs. 3.5, 3.8, 4.12). The
/// disturbance has no process noise, so its gain falls as 1/k.
Eigen::MatrixXd input_noise(const ExtendedPlant& plant, double q);

/// The other process noise of a KFD, Q = q·I on every state.
Eigen::MatrixXd uniform_noise(const ExtendedPlant& plant, double q);

/// The process noise of the disturbance Kalman filter (DKF): on d (order 0) or its highest
/// derivative alone.
Eigen::MatrixXd disturbance_noise(const ExtendedPlant& plant, double q);

}  // namespace breakwater
