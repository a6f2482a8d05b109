// Which disturbance estimator a scenario uses, and with which parameters.
#pragma once

#include <memory>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/rigs/axis_rig.h>
#include <breakwater/scenario/fields.h>

namespace breakwater {

enum class EstimatorKind { state_observer, mdob, idob, kfd, fakfd, vfakfd, qvff, stf };
enum class ProcessNoise { input, all, disturbance };

/// Keys `observer.…`. Each estimator uses those that it has; the others have no effect.
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
  /// observer.gamma and observer.gamma_d, where a scenario does not name gamma otherwise.
  void bind_gamma(Fields& fields);
};

/// The estimator of an axis, told of its nominal plant, period and sensor. Throws
/// std::invalid_argument if the settings define none.
std::unique_ptr<DisturbanceEstimator> make_estimator(const EstimatorSettings& settings,
                                                     const AxisSettings& axis);

}  // namespace breakwater
