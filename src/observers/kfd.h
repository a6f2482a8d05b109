// Kalman filter with disturbance estimation (KFD), disturbance Kalman filter (DKF):
// thesis 3.2, 4.2.2.
#pragma once

#include <breakwater/observers/kalman_estimator.h>

namespace breakwater {

/// The Kalman filter of the extended plant, Eqs. 3.7–3.11. (Eqs. 3.7 and 3.8 print the last
/// prediction in place of the last estimate.) The process noise selects the KFD (input_noise,
/// uniform_noise) or the DKF (disturbance_noise).
class Kfd final : public KalmanEstimator {
 public:
  explicit Kfd(const KalmanDesign& design) : KalmanEstimator(design) {}

  void update(const Vector& held_input, const Vector& y) override {
    predict(held_input, y);
    correct(R_);
  }
};

}  // namespace breakwater
