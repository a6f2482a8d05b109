// Feedback of all estimated states, with a reference and feed-forward of the disturbance. The
// linear quadratic regulator, with or without an estimator: the baselines of thesis 2.3.7.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/control/reference.h>
#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/observer_poles.h>
#include <breakwater/signals/axis_units.h>

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
  Reference reference;          ///< r
  double force_limit = std::numeric_limits<double>::infinity();  ///< limit of the drive
  double period_s = 0.0;                                         ///< T_s
  AxisUnits units;
  Eigen::VectorXd start_state;  ///< x̂(0), n
};

/// u(k) = u* − K (x̂(k) − x*). The plant rests at (x*, u*) under the estimated disturbance d̂(k),
/// with the controlled state at r:
///     A x* + B u* = E d̂, x*_c = r.
/// A constant disturbance therefore leaves no error, as with integral action, wherever it acts.
///
/// The estimator gets u after the drive's force limit. Expects the measured position as the first
/// entry of a sample.
class StateFeedback final : public Controller {
 public:
  /// Throws std::invalid_argument unless the sizes fit, period and limit are positive and the plant
  /// can rest at every reference.
  StateFeedback(std::shared_ptr<DisturbanceEstimator> estimator, const StateFeedbackDesign& design);

  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override;
  std::span<const Signal> signals() const override { return signals_; }
  /// Without a reader, the estimator's poles are not computed.
  void set_watched(bool is_watched) override { is_watched_ = is_watched; }

  /// u = K_r r + K_d d̂ − K x̂.
  double reference_gain() const { return reference_gain_; }
  double disturbance_gain() const { return disturbance_gain_; }

 private:
  std::shared_ptr<DisturbanceEstimator> estimator_;
  StateFeedbackDesign design_;
  ObserverPoles poles_;
  bool is_watched_ = true;
  double reference_gain_ = 0.0;
  double disturbance_gain_ = 0.0;
  double reference_ = 0.0;
  Eigen::VectorXd held_input_;
  std::vector<Signal> signals_;
};

/// u(k) = −K x̂(k) + d̂(k), or u(k) = −K x(k) with the true state and no estimate of d.
///
/// Expects samples with the measured position, followed by the true state (n).
class LqrControl final : public Controller {
 public:
  /// The estimator also runs with the true state, so that a log has its estimates. It gets u after
  /// the drive's limit. `K` is 1×n; the estimator starts at `start_state` (n). Throws
  /// std::invalid_argument if the sizes do not fit or the limit is not positive.
  LqrControl(std::shared_ptr<DisturbanceEstimator> estimator, Eigen::RowVectorXd K,
             Eigen::VectorXd start_state, bool uses_true_state,
             double force_limit = std::numeric_limits<double>::infinity());

  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override;
  std::span<const Signal> signals() const override { return signals_; }

  const DisturbanceEstimator& estimator() const { return *estimator_; }

 private:
  std::shared_ptr<DisturbanceEstimator> estimator_;
  Eigen::RowVectorXd K_;
  Eigen::VectorXd start_state_;
  bool uses_true_state_;
  double force_limit_;
  Eigen::VectorXd held_input_;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
