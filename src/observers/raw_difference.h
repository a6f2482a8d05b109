// The measurement itself as an estimate.
#pragma once

#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// x̂ = [measured positions; their differences over a sample], and no disturbance. The difference of
/// the first sample after a reset is 0.
class RawDifference final : public DisturbanceEstimator {
 public:
  /// The states of `plant` must be positions and their rates, and its outputs must be all
  /// positions. Throws std::invalid_argument otherwise.
  RawDifference(const StateSpace& plant, double period_s);

  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;
  View state() const override { return {x_.data(), x_.size()}; }
  View disturbance() const override { return {d_.data(), d_.size()}; }

 private:
  Eigen::MatrixXd to_positions_;  // from outputs
  double period_s_;
  bool is_first_ = true;
  Eigen::VectorXd last_;
  Eigen::VectorXd x_;
  Eigen::VectorXd d_;
};

}  // namespace breakwater
