// Feedback of all estimated states, with a reference and feed-forward of the disturbance. The
// linear quadratic regulator, with or without an estimator: the baselines of thesis 2.3.7.
#pragma once

#include <Eigen/Core>
#include <memory>

#include <breakwater/control/estimating_control.h>
#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>

namespace breakwater {

/// K (1×n), with which A − B K of the sampled plant has the poles e^{s T_s} of the continuous
/// `poles` s [1/s]. Throws as place_observer_poles() does.
Eigen::RowVectorXd place_feedback_poles(const StateSpace& continuous_plant, const PoleGroup& poles,
                                        double period_s);

struct StateFeedbackDesign {
  StateSpace plant;             ///< continuous, one input
  Eigen::VectorXd E;            ///< ẋ = A x + B u − E d
  Eigen::Index controlled = 0;  ///< the state that follows the reference
  Eigen::RowVectorXd K;         ///< 1×n
  AxisLoopDesign loop;
};

/// u(k) = u* − K (x̂(k) − x*). The plant rests at (x*, u*) under the estimated disturbance d̂(k),
/// with the controlled state at r:
///     A x* + B u* = E d̂, x*_c = r.
/// A constant disturbance therefore leaves no error, as with integral action, wherever it acts.
class StateFeedback final : public EstimatingControl {
 public:
  /// Throws std::invalid_argument as EstimatingControl does, and unless the sizes fit and the plant
  /// can rest at every reference.
  StateFeedback(std::shared_ptr<DisturbanceEstimator> estimator, const StateFeedbackDesign& design);

  /// u = K_r r + K_d d̂ − K x̂.
  double reference_gain() const { return reference_gain_; }
  double disturbance_gain() const { return disturbance_gain_; }

 private:
  double input(const Sample&) override {
    return reference_gain_ * reference() + disturbance_gain_ * disturbance() - K_.dot(state());
  }

  Eigen::RowVectorXd K_;
  double reference_gain_ = 0.0;
  double disturbance_gain_ = 0.0;
};

/// u(k) = −K x̂(k) + d̂(k), or u(k) = −K x(k) with the true state and no estimate of d.
///
/// Expects samples with the measured position, followed by the true state (n).
class LqrControl final : public EstimatingControl {
 public:
  /// The estimator also runs with the true state, so that a log has its estimates. `K` is 1×n.
  /// Throws std::invalid_argument as EstimatingControl does, and if the sizes do not fit.
  LqrControl(std::shared_ptr<DisturbanceEstimator> estimator, const AxisLoopDesign& loop,
             Eigen::RowVectorXd K, bool uses_true_state);

 private:
  double input(const Sample& y) override {
    return uses_true_state_ ? (-K_ * y.y.segment(1, K_.size())).value()
                            : (-K_ * state()).value() + disturbance();
  }

  Eigen::RowVectorXd K_;
  bool uses_true_state_;
};

}  // namespace breakwater
