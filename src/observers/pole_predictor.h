// A predictor of a plant with given poles of the estimation error.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/variable_hold.h>

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

}  // namespace breakwater
