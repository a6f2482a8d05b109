#include <breakwater/observers/guarded_kalman.h>

namespace breakwater {

KalmanDesign known_sensor_design(const ExtendedPlant& plant, const SensorError& sensor, double q,
                                 const Eigen::VectorXd& P0) {
  check(sensor, plant.outputs());
  return {plant, disturbance_noise(plant, q),
          sensor.variance().cwiseMax(kSmallestVariance).asDiagonal(), P0.asDiagonal()};
}

}  // namespace breakwater
