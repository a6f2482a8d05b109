// PD control with disturbance cancellation: thesis 4.2.4, 4.2.5 and 4.3.2. Its gains for resonance
// ratio control of two inertias.
#pragma once

#include <memory>
#include <utility>

#include <breakwater/control/estimating_control.h>
#include <breakwater/plants/motor_and_load.h>

namespace breakwater {

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
