// A plant's predictor whose error has given poles.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/variable_hold.h>

namespace breakwater {

/// x̂(k+1) = A x̂(k) + B u(k) + H (y(k) − C x̂(k)) of a plant sampled with a zero-order hold, where
/// A − H C has the poles e^{s h} of the continuous poles s over the interval h. x̂(k) has therefore
/// seen y(0) … y(k−1).
class PolePredictor {
 public:
  /// `poles` [1/s]: one group per output, n in all. Throws std::invalid_argument if one is not
  /// stable or they cannot be placed.
  PolePredictor(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles,
                double period_s);

  /// The intervals that follow are so long; 0: T_s. Plant and gain are those of this length, by
  /// Ackermann's formula for one output, by ObserverPlacement for several. Where an interval is so
  /// short that the poles of several outputs cannot be placed, the gain is that of T_s. Allocates
  /// nothing.
  void over(double interval_s);

  /// Starts from a state whose first entries are `x`, and the others 0; intervals are T_s again.
  void reset(const Eigen::Ref<const Eigen::VectorXd>& x);

  /// One sample: u acted since the last one, y is measured at this one. The first after a reset has
  /// no sample before it: u is ignored.
  void update(const Eigen::Ref<const Eigen::VectorXd>& u,
              const Eigen::Ref<const Eigen::VectorXd>& y);

  /// x̂(k) and y(k) − C x̂(k), at addresses that do not change.
  const Eigen::VectorXd& state() const { return state_; }
  const Eigen::VectorXd& innovation() const { return innovation_; }

  const Eigen::MatrixXd& H() const { return step_.gain; }
  /// A − H C: what the estimation error is multiplied with at each sample.
  const Eigen::MatrixXd& error_dynamics() const { return step_.error_dynamics; }

 private:
  struct Step {
    Eigen::MatrixXd gain;
    Eigen::MatrixXd error_dynamics;
    Eigen::MatrixXd B;
  };

  void place(double interval_s);

  std::vector<PoleGroup> poles_;
  std::vector<PoleGroup> sampled_poles_;  // of the last interval
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
