// Recorded sequences of quadratic programs as files for any solver.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include <breakwater/linear/qp.h>

namespace breakwater {

/// The programs of a predictive controller along a closed loop, as functions of the changing values
/// p = [x̂(k); u(k−1)]:
///     minimise ½ zᵀ H z + (g0 + G p)ᵀ z   subject to   lower0 + E p ≤ Ω z ≤ upper0 + E p.
/// The file also has the matrices of the controller, for solvers that use them
/// (qp_sequences/README).
struct QpSequence {
  QpModel model;
  Eigen::VectorXd g0;          // n
  Eigen::MatrixXd G;           // n × parameters
  Eigen::VectorXd lower0;      // m
  Eigen::VectorXd upper0;      // m
  Eigen::MatrixXd E;           // m × parameters
  Eigen::MatrixXd parameters;  // a column per program

  Eigen::MatrixXd A, B, Q, Q_last, R;  // matrices of the predictive controller (LmpcDesign)
  int prediction_steps = 0;
  /// For each row: 0: Δu(k + i), 1: u(k + i), 2: x(k + i); then i; then the component.
  Eigen::MatrixXi rows;

  std::size_t size() const { return static_cast<std::size_t>(parameters.cols()); }
  QpInput input(std::size_t k) const;
};

/// Both throw std::runtime_error if the file cannot be written or is not valid.
void write(const QpSequence& sequence, const std::string& file);
QpSequence read_qp_sequence(const std::string& file);

}  // namespace breakwater
