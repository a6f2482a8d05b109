// Which disturbance estimator a scenario uses, and with which parameters.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "linear/state_space.h"
#include "observers/disturbance_estimator.h"
#include "observers/sensor_error.h"
#include "scenario/fields.h"

namespace breakwater {

enum class EstimatorKind { mdob, idob, kfd, fakfd, vfakfd, qvff, stf };
enum class ProcessNoise { input, all, disturbance };

/// Keys `observer.…`. Each estimator uses those that it has; the others are read and left alone.
struct EstimatorSettings {
  EstimatorKind kind = EstimatorKind::kfd;
  int disturbance_order = 0;
  double derivative_cutoff_rad_s = 0.0;  ///< g_d; 0: the raw difference
  double observer_cutoff_rad_s = 0.0;    ///< g_w
  std::vector<double> poles_rad_s;
  ProcessNoise process_noise_on = ProcessNoise::input;
  double process_noise = 0.0;              ///< Q
  double observation_noise = 0.0;          ///< R
  std::vector<double> initial_covariance;  ///< diagonal of P0
  double gamma = 1.0;                      ///< of all states
  double gamma_d = 1.0;                    ///< of the disturbance and its derivatives, on top
  double alpha = 0.0;                      ///< 0: Eq. 4.26
  double lambda_min = 0.0;
  double lambda_max = 0.0;

  void bind(Fields& fields);
};

/// What an estimator is made for.
struct EstimatorTask {
  StateSpace continuous_plant;  ///< one axis
  double period_s = 0.0;
  SensorError sensor_error;
  double pulses_per_revolution = 0.0;  ///< b_reso of Eq. 4.26
};

/// Throws std::invalid_argument if the settings define no estimator.
std::unique_ptr<DisturbanceEstimator> make_estimator(const EstimatorSettings& settings,
                                                     const EstimatorTask& task);

}  // namespace breakwater
