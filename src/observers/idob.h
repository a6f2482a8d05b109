// Identity disturbance observer (IDOB): thesis 2.2.3, 2.2.3.1 and 2.4.2.1.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/observers/pole_predictor.h>

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
///
/// Used once a sample: read the estimate, decide the input, then update(u, y).
class Idob {
 public:
  /// `poles` [1/s]: one group per output, n + m poles in all, each stable. Throws
  /// std::invalid_argument if the extended plant is not observable (with its rank) or the poles
  /// cannot be placed.
  Idob(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles, double period_s);

  /// Starts from state `x` (n) and no disturbance.
  void reset(const Eigen::Ref<const Eigen::VectorXd>& x);

  /// One sample: u (m) is the input that the plant is given until the next one, y (p) what was
  /// measured at this one. Allocates nothing.
  void update(const Eigen::Ref<const Eigen::VectorXd>& u,
              const Eigen::Ref<const Eigen::VectorXd>& y);

  /// The intervals that follow are so long; 0: T_s.
  void over(double interval_s) { predictor_.over(interval_s); }

  auto state() const { return extended_state().head(states_); }
  auto disturbance() const { return extended_state().tail(extended_state().size() - states_); }
  /// [x̂; d̂], at an address that does not change.
  const Eigen::VectorXd& extended_state() const { return predictor_.state(); }

  const Eigen::MatrixXd& H() const { return predictor_.H(); }
  /// Ā_d − H C̄_d: what the estimation error is multiplied with at each sample.
  const Eigen::MatrixXd& error_dynamics() const { return predictor_.error_dynamics(); }

 private:
  Eigen::Index states_;
  PolePredictor predictor_;
};

}  // namespace breakwater
