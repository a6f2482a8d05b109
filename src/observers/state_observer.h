// A state observer without a disturbance model, case (b) of thesis 2.3.6. The IDOB is one of the
// extended plant.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// x̂(k+1) = A x̂(k) + B u(k) + H (y(k) − C x̂(k)) with d̂ = 0 for a plant sampled with a zero-order
/// hold. A − H C has the poles e^{s h}, with the continuous poles s and the interval h. x̂(k)
/// depends on y(0) … y(k−1).
class StateObserver : public DisturbanceEstimator {
 public:
  /// `poles` [1/s], continuous and stable: n in all, one group per output. Throws
  /// std::invalid_argument if a pole is not stable or the placement fails.
  StateObserver(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles,
                double period_s)
      : plant_(continuous_plant), poles_(poles), period_s_(period_s), interval_s_(period_s) {
    const StateSpace sampled = zero_order_hold(plant_, period_s);
    regular_ =
        step_of(sampled, place_observer_poles(sampled.A, sampled.C, sample_poles(poles, period_s)));
    step_ = regular_;
    state_.setZero(plant_.states());
    disturbance_.setZero(plant_.inputs());
    next_.setZero(plant_.states());
    last_output_.setZero(plant_.outputs());
    innovation_ = last_output_;
    signals_ = {{"innovation", "", "e = y - C x(k|k-1) (Eq. 4.15)", view(innovation_)}};
  }

  /// Starts from the first states `x` and 0 for the others.
  void reset(const Vector& x) override {
    state_.setZero();
    state_.head(x.size()) = x;
    has_begun_ = false;
    follow({});
  }
  void update(const Vector& held_input, const Vector& y) override {
    if (has_begun_) {
      next_.noalias() = step_.error_dynamics * state_;
      next_.noalias() += step_.B * held_input;
      next_.noalias() += step_.gain * last_output_;
      // Copies, does not swap: a log holds the address of the state.
      state_ = next_;
    }
    has_begun_ = true;
    last_output_ = y;
    innovation_ = y;
    innovation_.noalias() -= plant_.C * state_;
  }
  /// Samples the plant and places the poles anew. If the interval is too short or too long for
  /// this, the gain for T_s stays.
  bool follow(const SampleInterval& interval) override {
    const double length_s = interval.length_s > 0.0 ? interval.length_s : period_s_;
    if (length_s == interval_s_) return true;
    interval_s_ = length_s;
    if (length_s == period_s_) {
      step_ = regular_;
      return true;
    }
    const StateSpace sampled = zero_order_hold(plant_, length_s);
    const std::vector<PoleGroup> poles = sample_poles(poles_, length_s);
    step_ = step_of(sampled, regular_.gain);
    try {
      const Step placed = step_of(sampled, place_observer_poles(sampled.A, sampled.C, poles));
      // For a very short interval the poles are close to 1, and rounding may move them.
      constexpr double kLargestError = 1e-6;
      double sum = 0.0;
      for (const PoleGroup& group : poles) {
        for (const std::complex<double>& pole : group) sum += pole.real();
      }
      if (std::abs(placed.error_dynamics.trace() - sum) < kLargestError) step_ = placed;
    } catch (const std::invalid_argument&) {
      return true;  // a mode has decayed within a long interval, so its poles cannot be placed
    }
    return true;
  }

  View state() const override { return {state_.data(), state_.size()}; }
  View disturbance() const override { return {disturbance_.data(), disturbance_.size()}; }

  /// The poles are those of A − H C, which multiplies the estimation error at each sample.
  Eigen::Index poles() const override { return state_.size(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override { F = step_.error_dynamics; }

 private:
  struct Step {
    Eigen::MatrixXd gain;            // H
    Eigen::MatrixXd error_dynamics;  // A − H C
    Eigen::MatrixXd B;
  };

  static Step step_of(const StateSpace& sampled, const Eigen::MatrixXd& H) {
    return {H, sampled.A - H * sampled.C, sampled.B};
  }

  StateSpace plant_;
  std::vector<PoleGroup> poles_;
  Step regular_;
  Step step_;
  double period_s_;
  double interval_s_;
  bool has_begun_ = false;
  Eigen::VectorXd state_;
  Eigen::VectorXd disturbance_;  // always 0
  Eigen::VectorXd next_;
  Eigen::VectorXd last_output_;
  Eigen::VectorXd innovation_;
};

}  // namespace breakwater
