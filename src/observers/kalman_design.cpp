#include <breakwater/observers/kalman_design.h>

#include <stdexcept>
#include <string>

#include <breakwater/linear/riccati.h>

namespace breakwater {
namespace {

constexpr double kLargest = 1e100;  // products of larger covariances overflow

void require(bool fulfilled, Eigen::Index size, const std::string& what) {
  if (fulfilled) return;
  throw std::invalid_argument("Kalman filter: " + what + " and " + std::to_string(size) + "×" +
                              std::to_string(size));
}

}  // namespace

void check(const KalmanDesign& design) {
  const Eigen::Index N = design.plant.states();
  const Eigen::Index p = design.plant.outputs();
  require(design.Q.rows() == N && is_positive_semidefinite(design.Q), N,
          "Q must be symmetric positive semidefinite");
  require(design.R.rows() == p && is_positive_definite(design.R), p,
          "R must be symmetric positive definite");
  require(design.P0.rows() == N && is_positive_definite(design.P0), N,
          "P0 must be symmetric positive definite");
  for (const Eigen::MatrixXd* covariance : {&design.Q, &design.R, &design.P0}) {
    if (covariance->cwiseAbs().maxCoeff() <= kLargest) continue;
    throw std::invalid_argument("Kalman filter: Q, R and P0 must be at most 1e100");
  }
}

Eigen::MatrixXd input_noise(const ExtendedPlant& plant, double q) {
  return plant.sampled.B * q * plant.sampled.B.transpose();
}

Eigen::MatrixXd uniform_noise(const ExtendedPlant& plant, double q) {
  return q * Eigen::MatrixXd::Identity(plant.states(), plant.states());
}

Eigen::MatrixXd disturbance_noise(const ExtendedPlant& plant, double q) {
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(plant.states(), plant.states());
  Q.diagonal().tail(plant.inputs()).setConstant(q);
  return Q;
}

}  // namespace breakwater
