#include <breakwater/observers/qvff.h>

namespace breakwater {
namespace {

constexpr double kQuantumShare = 1.0;
constexpr double kNoiseShare = 4.5;
constexpr double kQuantumThreshold = 0.5;
constexpr double kNoiseThreshold = 1.5;
constexpr double kSmallestAlpha = 1e-22;  // the error of the arithmetic in place of the sensor's

}  // namespace

VfakfdDesign qvff_design(const SensorError& error) {
  check(error, error.quantum.size());
  VfakfdDesign design;
  design.dead_zone = kQuantumShare * error.quantum + kNoiseShare * error.noise_std;
  design.alpha = (kQuantumThreshold * error.quantum)
                     .cwiseAbs2()
                     .cwiseMax((kNoiseThreshold * error.noise_std).cwiseAbs2())
                     .cwiseMax(kSmallestAlpha);
  return design;
}

KalmanDesign variable_forgetting_design(const ExtendedPlant& plant, double p0) {
  const Eigen::Index N = plant.states();
  return {plant, Eigen::MatrixXd::Zero(N, N),
          Eigen::MatrixXd::Identity(plant.outputs(), plant.outputs()),
          p0 * Eigen::MatrixXd::Identity(N, N)};
}

}  // namespace breakwater
