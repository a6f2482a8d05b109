// Feedback of all estimated states, with a reference and feed-forward of the disturbance. PD
// control with disturbance cancellation (thesis 4.2.4, 4.2.5 and 4.3.2), and its gains for
// resonance ratio control of two inertias. The linear quadratic regulator, with or without an
// estimator: the baselines of thesis 2.3.7.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>

#include <breakwater/control/estimating_control.h>
#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/plants/motor_and_load.h>

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

struct DisturbanceCancellingPdDesign {
  double k_p = 0.0;              ///< K_p, force per position
  double k_d = 0.0;              ///< K_d, force per velocity
  double cancelled_share = 1.0;  ///< κ, the cancelled part of d̂
  AxisLoopDesign loop;           ///< with y_ref
};

/// State feedback of one axis:
///     u(k) = K_p (y_ref − ŷ(k)) − K_d v̂(k) + κ d̂(k)   (Eqs. 4.10, 4.22 with κ = 1).
class DisturbanceCancellingPd final : public EstimatingControl {
 public:
  /// Throws std::invalid_argument as EstimatingControl does.
  DisturbanceCancellingPd(std::shared_ptr<DisturbanceEstimator> estimator,
                          const DisturbanceCancellingPdDesign& design)
      : EstimatingControl(std::move(estimator), design.loop), design_(design) {}

 private:
  double input(const Sample&) override {
    return design_.k_p * (reference() - state()(0)) - design_.k_d * state()(1) +
           design_.cancelled_share * disturbance();
  }

  DisturbanceCancellingPdDesign design_;
};

/// Resonance ratio control, u = K_p (r − q_m) − K_d q̇_m + (1 − K_r) τ̂. A disturbance observer of
/// the motor alone cancels τ̂, the spring's torque and friction. Feedback of K_r times this torque
/// gives the motor the virtual inertia J_m/K_r, and so the virtual resonance ratio
///     H² = ω_r²/ω_a² = 1 + K_r J_l/(N² J_m).
/// With H² = 1 + 4ζ², K_p = J_m ω_a² and K_d = 4ζ J_m ω_a the loop has the characteristic
/// polynomial
///     (s² + 2ζ ω_a s + ω_a²)².
/// Returns these gains, with κ = 1 − K_r and the loop of no axis yet. ζ = 1 gives H = √5. The
/// reference r is that of the motor. A constant torque on the load leaves an error, because K_r τ̂
/// gives way to it.
///
/// Source: K. Yuki, T. Murakami, K. Ohnishi, "Vibration control of a 2 mass resonant system by the
/// resonance ratio control", IECON 1993, 2009–2014. Throws std::invalid_argument as check() does,
/// and unless ζ is positive.
DisturbanceCancellingPdDesign resonance_ratio(const TwoInertia& plant, double damping_ratio);

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
