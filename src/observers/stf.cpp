#include <breakwater/observers/stf.h>

#include <stdexcept>

namespace breakwater {
namespace {

constexpr double kPriorShare = 0.01;

}  // namespace

KalmanDesign stf_design(const ExtendedPlant& plant, const SensorError& error, double period_s) {
  check(error, plant.outputs());
  if (!(period_s > 0.0)) throw std::invalid_argument("STF: the sampling period must be positive");
  const Eigen::VectorXd variance = error.variance().cwiseMax(kSmallestVariance);
  Eigen::VectorXd prior =
      Eigen::VectorXd::Constant(plant.states(), kPriorShare * variance.maxCoeff());
  prior.tail(plant.states() - plant.plant_states) /= period_s * period_s;
  return {plant, Eigen::MatrixXd::Zero(plant.states(), plant.states()), variance.asDiagonal(),
          prior.asDiagonal()};
}

}  // namespace breakwater
