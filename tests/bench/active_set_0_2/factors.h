// What the active set of version 0.2 was made of: kept to measure later ones against.
#pragma once

#include <breakwater/linear/qp.h>

namespace breakwater::v0_2 {

double kkt_residual(const QpModel& model, const QpInput& input, const QpSolution& solution,
                    const Eigen::VectorXd& values, Eigen::VectorXd& gradient);

/// What solvers share: a model with what follows from it alone.
struct QpFactors {
  QpModel model;
  Eigen::MatrixXd columns;    ///< Ω again, by columns: faster to multiply where n is small
  Eigen::MatrixXd H_inverse;  ///< n×n
  Eigen::MatrixXd step;       ///< H⁻¹ Ωᵀ, n×m: how z answers to a row's multiplier
  Eigen::MatrixXd gram;       ///< Ω H⁻¹ Ωᵀ, m×m: how the rows do

  /// Throws std::invalid_argument as make_qp_solver.
  explicit QpFactors(QpModel qp);

  Eigen::Index variables() const { return model.H.rows(); }
  Eigen::Index rows() const { return model.Omega.rows(); }

  /// What is wrong with an input before anything is solved, or `solved` if nothing is: not_finite,
  /// or infeasible where a lower bound is above its upper one.
  static QpStatus examine(const QpInput& input);
};

}  // namespace breakwater::v0_2
