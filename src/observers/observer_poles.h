// The poles of an estimator at each sample: thesis 4.3.4.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// The eigenvalues p_d of A̅ − K(k) C̅, and the continuous poles p_c with p_d = e^{T_s p_c}. Both
/// are sorted by their real parts.
class ObserverPoles {
 public:
  /// The estimator must outlive this. Throws std::invalid_argument if the period is not positive.
  ObserverPoles(const DisturbanceEstimator& estimator, double period_s);

  /// Call it once a sample, after the estimator's update. Does nothing while the matrix is
  /// constant. Allocates nothing.
  void update();

  /// Real and imaginary parts of p_d, then of p_c; empty if the estimator has no poles.
  std::span<const Signal> signals() const { return signals_; }

 private:
  const DisturbanceEstimator& estimator_;
  double period_s_;
  Eigen::MatrixXd matrix_;
  Eigen::MatrixXd solved_;  // the matrix of the current poles
  EigenvalueSolver solver_;
  Eigen::VectorXcd discrete_;
  Eigen::MatrixX4d parts_;  // the signals' values
  std::vector<Signal> signals_;
};

}  // namespace breakwater
