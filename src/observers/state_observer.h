// A state observer without a disturbance model, case (b) of thesis 2.3.6. The IDOB is one of the
// extended plant.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// x̂(k+1) = A x̂(k) + B u(k) + H (y(k) − C x̂(k)) with d̂ = 0 for a plant sampled with a zero-order
/// hold. A − H C has the poles e^{s h}, with the continuous poles s and the interval h. x̂(k)
/// depends on y(0) … y(k−1).
class StateObserver : public DisturbanceEstimator {
 public:
  /// `poles` [1/s], continuous and stable: n in all, one group per output. Throws
  /// std::invalid_argument if a pole is not stable or the placement fails.
  StateObserver(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles,
                double period_s);

  /// Starts from the first states `x` and 0 for the others.
  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;
  /// Samples the plant and places the poles anew. If the interval is too short or too long for
  /// this, the gain for T_s stays.
  bool follow(const SampleInterval& interval) override;

  View state() const override { return {state_.data(), state_.size()}; }
  View disturbance() const override { return {disturbance_.data(), disturbance_.size()}; }

  /// The poles are those of A − H C, which multiplies the estimation error at each sample.
  Eigen::Index poles() const override { return state_.size(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override { F = step_.error_dynamics; }

 private:
  struct Step {
    Eigen::MatrixXd gain;            // H
    Eigen::MatrixXd error_dynamics;  // A − H C
    Eigen::MatrixXd B;
  };

  static Step step_of(const StateSpace& sampled, Eigen::MatrixXd H);

  StateSpace plant_;
  std::vector<PoleGroup> poles_;
  Step regular_;
  Step step_;
  double period_s_;
  double interval_s_;
  bool has_begun_ = false;
  Eigen::VectorXd state_;
  Eigen::VectorXd disturbance_;  // always 0
  Eigen::VectorXd next_;
  Eigen::VectorXd last_output_;
  Eigen::VectorXd innovation_;
};

}  // namespace breakwater
