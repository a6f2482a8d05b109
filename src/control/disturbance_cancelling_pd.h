// PD control with disturbance cancellation: thesis 4.2.4, 4.2.5 and 4.3.2. Its gains for resonance
// ratio control of two inertias.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/control/reference.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/observer_poles.h>
#include <breakwater/plants/motor_and_load.h>
#include <breakwater/signals/axis_units.h>

namespace breakwater {

struct DisturbanceCancellingPdDesign {
  double k_p = 0.0;                                              ///< K_p, force per position
  double k_d = 0.0;                                              ///< K_d, force per velocity
  double cancelled_share = 1.0;                                  ///< κ, the cancelled part of d̂
  Reference reference;                                           ///< y_ref
  double force_limit = std::numeric_limits<double>::infinity();  ///< limit of the drive
  double period_s = 0.0;                                         ///< T_s
  AxisUnits units;
  Eigen::VectorXd start_state = Eigen::Vector2d::Zero();  ///< start of the estimator, n
};

/// State feedback of one axis with an estimator:
///     u(k) = K_p (y_ref − ŷ(k)) − K_d v̂(k) + κ d̂(k)   (Eqs. 4.10, 4.22 with κ = 1).
/// The estimates are those of the same sample. The estimator gets u after the drive's force limit.
/// All other effects of the drive are part of d̂.
///
/// Expects the measured position as the first entry of a sample.
class DisturbanceCancellingPd final : public Controller {
 public:
  /// Throws std::invalid_argument unless period and limit are positive and the estimator has one
  /// axis.
  DisturbanceCancellingPd(std::shared_ptr<DisturbanceEstimator> estimator,
                          const DisturbanceCancellingPdDesign& design);

  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override;
  std::span<const Signal> signals() const override { return signals_; }
  /// Without a reader, the estimator's poles are not computed.
  void set_watched(bool is_watched) override { is_watched_ = is_watched; }

  double reference() const { return reference_; }
  double position() const { return estimator_->state()(0); }
  double velocity() const { return estimator_->state()(1); }
  double disturbance() const { return estimator_->disturbance()(0); }

 private:
  std::shared_ptr<DisturbanceEstimator> estimator_;
  DisturbanceCancellingPdDesign design_;
  ObserverPoles poles_;
  bool is_watched_ = true;
  double reference_ = 0.0;
  Eigen::VectorXd held_input_;
  std::vector<Signal> signals_;
};

/// u = K_p (r − q_m) − K_d q̇_m + τ̂ − K_r τ̂, where τ̂ is the disturbance of the motor alone: the
/// spring's torque and friction.
struct ResonanceRatioGains {
  double k_p = 0.0;
  double k_d = 0.0;
  double reaction = 0.0;  ///< K_r

  /// The part of τ̂ that is cancelled.
  double cancelled_share() const { return 1.0 - reaction; }
};

/// A disturbance observer of the motor cancels the spring's torque. Feedback of K_r times this
/// torque gives the motor the virtual inertia J_m/K_r, and so the virtual resonance ratio
///     H² = ω_r²/ω_a² = 1 + K_r J_l/(N² J_m).
/// With H² = 1 + 4ζ², K_p = J_m ω_a² and K_d = 4ζ J_m ω_a the loop has the characteristic
/// polynomial
///     (s² + 2ζ ω_a s + ω_a²)².
/// ζ = 1 gives H = √5. The reference r is that of the motor. A constant torque on the load leaves
/// an error, because K_r τ̂ gives way to it.
///
/// Source: K. Yuki, T. Murakami, K. Ohnishi, "Vibration control of a 2 mass resonant system by the
/// resonance ratio control", IECON 1993, 2009–2014. Throws std::invalid_argument as check() does,
/// and unless ζ is positive.
ResonanceRatioGains resonance_ratio(const TwoInertia& plant, double damping_ratio);

}  // namespace breakwater
