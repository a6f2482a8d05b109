// A state observer without a disturbance model, case (b) of thesis 2.3.6, and the predictor with
// placed poles that it shares with the IDOB.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// x̂(k+1) = A x̂(k) + B u(k) + H (y(k) − C x̂(k)) for a plant sampled with a zero-order hold. A −
/// H C has the poles e^{s h}, with the continuous poles s and the interval h. x̂(k) depends on y(0)
/// … y(k−1).
class PolePredictor {
 public:
  /// `poles` [1/s]: one group per output, n in all. Throws std::invalid_argument if a pole is not
  /// stable or the placement fails.
  PolePredictor(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles,
                double period_s);

  /// Sets the length of the next intervals; 0: T_s. Samples the plant and places the poles anew:
  /// one output by Ackermann's formula, several by ObserverPlacement. If the interval is too short
  /// for this, the gain for T_s stays. Allocates nothing.
  void over(double interval_s);

  /// Starts from the first states `x` and 0 for the others. The interval is T_s again.
  void reset(const Eigen::Ref<const Eigen::VectorXd>& x);

  /// One sample: u acted since the last one, y is measured now. The first one ignores u.
  void update(const Eigen::Ref<const Eigen::VectorXd>& u,
              const Eigen::Ref<const Eigen::VectorXd>& y);

  /// x̂(k) and y(k) − C x̂(k), at addresses that do not change.
  const Eigen::VectorXd& state() const { return state_; }
  const Eigen::VectorXd& innovation() const { return innovation_; }

  const Eigen::MatrixXd& H() const { return step_.gain; }
  /// A − H C, the dynamics of the estimation error.
  const Eigen::MatrixXd& error_dynamics() const { return step_.error_dynamics; }

 private:
  struct Step {
    Eigen::MatrixXd gain;
    Eigen::MatrixXd error_dynamics;
    Eigen::MatrixXd B;
  };

  void place(double interval_s);

  std::vector<PoleGroup> poles_;
  std::vector<PoleGroup> sampled_poles_;  // for the last interval
  ObserverPlacement placement_;           // for several outputs
  Step regular_;
  Step step_;
  double period_s_;
  double interval_s_;
  VariableHold hold_;
  Eigen::MatrixXd C_;
  bool has_begun_ = false;
  Eigen::VectorXd state_;
  Eigen::VectorXd next_;
  Eigen::VectorXd last_output_;
  Eigen::VectorXd innovation_;
  // Work space of Ackermann's formula.
  Eigen::MatrixXd change_;  // A − I
  Eigen::MatrixXd observability_;
  Eigen::MatrixXd polynomial_;
  Eigen::MatrixXd factor_;
  Eigen::MatrixXd work_;
  Eigen::VectorXd last_;  // (0, …, 0, 1)
  Eigen::PartialPivLU<Eigen::MatrixXd> solver_;
};

/// x̂(k+1) = A x̂(k) + B u(k) + H (y(k) − C x̂(k)) with d̂ = 0, for comparison with the disturbance
/// observers. x̂(k) depends on y(0) … y(k−1), as with the IDOB.
class StateObserver : public DisturbanceEstimator {
 public:
  /// `poles` [1/s], continuous and stable: n in all, one group per output. Throws
  /// std::invalid_argument if a pole is not stable or the placement fails.
  StateObserver(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles,
                double period_s);

  void reset(const Vector& x) override { predictor_.reset(x); }
  void update(const Vector& held_input, const Vector& y) override {
    predictor_.update(held_input, y);
  }
  bool follow(const SampleInterval& interval) override {
    predictor_.over(interval.length_s);
    return true;
  }

  View state() const override { return {predictor_.state().data(), poles()}; }
  View disturbance() const override { return {disturbance_.data(), disturbance_.size()}; }
  std::span<const Signal> signals() const override { return signals_; }

  /// The poles are those of A − H C, which multiplies the estimation error at each sample.
  Eigen::Index poles() const override { return predictor_.state().size(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override {
    F = predictor_.error_dynamics();
  }

  const Eigen::MatrixXd& H() const { return predictor_.H(); }

 private:
  PolePredictor predictor_;
  Eigen::VectorXd disturbance_;  // always 0
  std::vector<Signal> signals_;
};

}  // namespace breakwater
