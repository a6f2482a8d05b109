// Identity disturbance observer (IDOB): thesis 2.2.3, 2.2.3.1 and 2.4.2.1.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/observers/state_observer.h>

namespace breakwater {

/// Estimates a plant's state and the disturbance at each of its inputs at once.
///
/// Plant, with a step-type disturbance d that opposes the input (Eqs. 2.4, 2.7, 2.8, 2.53):
///     ẋ = A x + B (u − d),   ḋ = 0,   y = C x.
/// The extended state x̄ = [x; d] is sampled with a zero-order hold (Eqs. 2.18–2.20), and the
/// observer is the predictor of Eqs. 2.21 and 2.22, H = [H_state; H_dis]:
///     x̄(k+1) = Ā_d x̄(k) + B̄_d u(k) + H (y(k) − C̄_d x̄(k)).
/// H places the poles z = e^{s T_s} of the continuous poles s (place_observer_poles). What is read
/// at sample k is therefore x̄(k), which has seen y(0) … y(k−1).
///
/// Sign: d̂ opposes the input, so a plant with nominal inertia J_n is given the acceleration a by
/// u = J_n a + d̂ (Eq. 2.82). Eqs. 2.6 and 2.15 print the other sign.
class Idob final : public StateObserver {
 public:
  /// `poles` [1/s]: one group per output, n + m poles in all, each stable. Throws
  /// std::invalid_argument if the extended plant is not observable (with its rank) or the poles
  /// cannot be placed.
  Idob(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles, double period_s);

  View state() const override { return {StateObserver::state().data(), states_}; }
  View disturbance() const override {
    return {StateObserver::state().data() + states_, poles() - states_};
  }

 private:
  Eigen::Index states_;
};

}  // namespace breakwater
