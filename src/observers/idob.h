// Identity disturbance observer (IDOB): thesis 2.2.3, 2.2.3.1 and 2.4.2.1.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/pole_predictor.h>

namespace breakwater {

/// Full-order observer of a plant's state and of the disturbance at each input.
///
/// Plant, with a step-type disturbance d that opposes the input (Eqs. 2.4, 2.7, 2.8, 2.53):
///     ẋ = A x + B (u − d),   ḋ = 0,   y = C x.
/// The extended state x̄ = [x; d] is sampled with a zero-order hold (Eqs. 2.18–2.20). The observer
/// is the predictor of Eqs. 2.21 and 2.22, H = [H_state; H_dis]:
///     x̄(k+1) = Ā_d x̄(k) + B̄_d u(k) + H (y(k) − C̄_d x̄(k)).
/// H places the poles z = e^{s T_s} of the continuous poles s (place_observer_poles). The estimate
/// at sample k is therefore x̄(k), from y(0) … y(k−1).
///
/// Sign: d̂ opposes the input. With the nominal inertia J_n, u = J_n a + d̂ gives the acceleration
/// a (Eq. 2.82). Eqs. 2.6 and 2.15 print the other sign.
class Idob final : public DisturbanceEstimator {
 public:
  /// `poles` [1/s]: one group per output, n + m stable poles in all. Throws std::invalid_argument
  /// if the extended plant is not observable (with its rank) or the placement fails.
  Idob(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles, double period_s);

  void reset(const Vector& x) override { predictor_.reset(x); }
  void update(const Vector& held_input, const Vector& y) override {
    predictor_.update(held_input, y);
  }
  bool follow(const SampleInterval& interval) override {
    predictor_.over(interval.length_s);
    return true;
  }

  View state() const override { return {predictor_.state().data(), states_}; }
  View disturbance() const override {
    return {predictor_.state().data() + states_, poles() - states_};
  }
  std::span<const Signal> signals() const override { return signals_; }

  /// The poles of Ā_d − H C̄_d, the dynamics of the estimation error.
  Eigen::Index poles() const override { return predictor_.state().size(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override {
    F = predictor_.error_dynamics();
  }

  const Eigen::MatrixXd& H() const { return predictor_.H(); }

 private:
  Eigen::Index states_;
  PolePredictor predictor_;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
