// The poles of an estimator, from sample to sample: thesis 4.3.4.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <span>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// The eigenvalues p_d of A̅ − K(k) C̅ and, by p_d = e^{T_s p_c}, the continuous poles p_c. In the
/// order of their real parts, so that each keeps its place.
class ObserverPoles {
 public:
  /// The estimator outlives this. Throws std::invalid_argument if the period is not positive.
  ObserverPoles(const DisturbanceEstimator& estimator, double period_s);

  /// To be called once a sample, after the estimator's update. Allocates nothing. Where the matrix
  /// is the last one again, as of an estimator with constant gains, there is nothing to compute.
  void update();

  const Eigen::VectorXcd& discrete() const { return discrete_; }
  const Eigen::VectorXcd& continuous() const { return continuous_; }

  /// Real and imaginary parts of both; none of an estimator that tells of no poles.
  std::span<const Signal> signals() const { return signals_; }

 private:
  const DisturbanceEstimator& estimator_;
  double period_s_;
  Eigen::MatrixXd matrix_;
  Eigen::MatrixXd solved_;  // the matrix that the poles are those of
  Eigen::EigenSolver<Eigen::MatrixXd> solver_;
  Eigen::VectorXcd discrete_;
  Eigen::VectorXcd continuous_;
  Eigen::VectorXd discrete_real_;
  Eigen::VectorXd discrete_imaginary_;
  Eigen::VectorXd continuous_real_;
  Eigen::VectorXd continuous_imaginary_;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
