// A plant under held inputs, over intervals of any length.
#pragma once

#include <Eigen/Core>

#include <breakwater/linear/state_space.h>

namespace breakwater {

/// zero_order_hold() over one interval after another: A and B of any length, without allocating. By
/// the exponential's series, its argument halved until it is small and the result squared as often.
class VariableHold {
 public:
  /// Throws std::invalid_argument as check() does.
  explicit VariableHold(const StateSpace& continuous);

  /// `interval_s` is positive.
  void over(double interval_s);

  auto A() const { return transition_.topLeftCorner(states_, states_); }
  auto B() const { return transition_.topRightCorner(states_, transition_.cols() - states_); }

 private:
  Eigen::Index states_;
  Eigen::MatrixXd generator_;   // [A B; 0 0]
  double norm_;                 // its largest column's sum
  Eigen::MatrixXd scaled_;      // times a part of the interval
  Eigen::MatrixXd transition_;  // its exponential
  Eigen::MatrixXd term_;
  Eigen::MatrixXd work_;
};

}  // namespace breakwater
