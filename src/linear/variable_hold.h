// A plant with held inputs, for intervals of any length.
#pragma once

#include <Eigen/Core>

#include <breakwater/linear/state_space.h>

namespace breakwater {

/// zero_order_hold() for one interval after another of any length, without allocation. It uses the
/// series of the matrix exponential with scaling and squaring.
class VariableHold {
 public:
  /// Throws std::invalid_argument as check() does.
  explicit VariableHold(const StateSpace& continuous);

  /// Sets the interval; `interval_s` must be positive.
  void over(double interval_s);

  auto A() const { return transition_.topLeftCorner(states_, states_); }
  auto B() const { return transition_.topRightCorner(states_, transition_.cols() - states_); }

 private:
  Eigen::Index states_;
  Eigen::MatrixXd generator_;   // [A B; 0 0]
  double norm_;                 // largest column sum
  Eigen::MatrixXd scaled_;      // the generator times a part of the interval
  Eigen::MatrixXd transition_;  // its exponential
  Eigen::MatrixXd term_;
  Eigen::MatrixXd work_;
};

}  // namespace breakwater
