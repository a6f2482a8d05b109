// A plain state observer, which knows of no disturbance: case (b) of thesis 2.3.6.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// x̂(k+1) = A x̂(k) + B u(k) + H (y(k) − C x̂(k)), with d̂ = 0: what stands beside the disturbance
/// observers to show what they add. As with the IDOB, x̂(k) has seen y(0) … y(k−1).
class StateObserver final : public DisturbanceEstimator {
 public:
  /// `poles` [1/s], continuous, n in all, one group per output, each stable. Throws
  /// std::invalid_argument if one is not, or they cannot be placed.
  StateObserver(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles,
                double period_s);

  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;

  View state() const override { return {state_.data(), state_.size()}; }
  View disturbance() const override { return {disturbance_.data(), disturbance_.size()}; }
  std::span<const Signal> signals() const override { return signals_; }

  Eigen::Index poles() const override { return state_.size(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override { F = error_dynamics_; }

 private:
  StateSpace plant_;                // sampled
  Eigen::MatrixXd gain_;            // H
  Eigen::MatrixXd error_dynamics_;  // A − H C
  Eigen::VectorXd state_;
  Eigen::VectorXd next_;
  Eigen::VectorXd disturbance_;  // 0
  bool has_begun_ = false;
  Eigen::VectorXd last_output_;
  Eigen::VectorXd innovation_;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
