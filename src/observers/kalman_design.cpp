#include "observers/kalman_design.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <stdexcept>
#include <string>

namespace breakwater {
namespace {

// Rounding of what a caller computed, relative to the largest entry.
constexpr double kSlack = 1e-12;

void check_symmetric(const Eigen::MatrixXd& matrix, Eigen::Index size, const std::string& name) {
  if (matrix.rows() != size || matrix.cols() != size || !matrix.allFinite()) {
    throw std::invalid_argument("Kalman filter: " + name + " must be " + std::to_string(size) +
                                "×" + std::to_string(size) + " and finite");
  }
  if ((matrix - matrix.transpose()).cwiseAbs().maxCoeff() > kSlack * matrix.cwiseAbs().maxCoeff()) {
    throw std::invalid_argument("Kalman filter: " + name + " must be symmetric");
  }
}

void check_positive_definite(const Eigen::MatrixXd& matrix, Eigen::Index size,
                             const std::string& name) {
  check_symmetric(matrix, size, name);
  if (Eigen::LLT<Eigen::MatrixXd>(matrix).info() != Eigen::Success) {
    throw std::invalid_argument("Kalman filter: " + name + " must be positive definite");
  }
}

}  // namespace

void check(const KalmanDesign& design) {
  const Eigen::Index size = design.plant.states();
  check_symmetric(design.Q, size, "Q");
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(design.Q, Eigen::EigenvaluesOnly)
          .eigenvalues();
  if (eigenvalues.minCoeff() < -kSlack * eigenvalues.cwiseAbs().maxCoeff()) {
    throw std::invalid_argument("Kalman filter: Q must be positive semidefinite");
  }
  check_positive_definite(design.R, design.plant.outputs(), "R");
  check_positive_definite(design.P0, size, "P0");
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
