// What the Kalman filters with disturbance estimation are designed with.
#pragma once

#include <breakwater/observers/disturbance_model.h>

namespace breakwater {

/// Only the ratios of Q, R and P0 matter to the estimates.
struct KalmanDesign {
  ExtendedPlant plant;
  Eigen::MatrixXd Q;   ///< N×N: what the process noise adds to P(k|k−1) at each sample
  Eigen::MatrixXd R;   ///< p×p: covariance of the observation noise (Eq. 3.6)
  Eigen::MatrixXd P0;  ///< N×N: P(0|−1), the prior of the first measurement
};

/// Throws std::invalid_argument unless the shapes fit, Q is symmetric and positive semidefinite, R
/// and P0 symmetric and positive definite.
void check(const KalmanDesign& design);

/// The process noise of the KFD: it enters as the input does, Q = B̅ q B̅ᵀ (Eqs. 3.5, 3.8 and
/// 4.12). It does not reach the disturbance, whose gain therefore fades as 1/k.
Eigen::MatrixXd input_noise(const ExtendedPlant& plant, double q);

/// The other form of the KFD, Q = q·I: every state walks.
Eigen::MatrixXd uniform_noise(const ExtendedPlant& plant, double q);

/// The process noise of the disturbance Kalman filter (DKF): only the disturbance, or the highest
/// of its derivatives, walks.
Eigen::MatrixXd disturbance_noise(const ExtendedPlant& plant, double q);

}  // namespace breakwater
