// A plain state observer, which knows of no disturbance: case (b) of thesis 2.3.6.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/pole_predictor.h>

namespace breakwater {

/// x̂(k+1) = A x̂(k) + B u(k) + H (y(k) − C x̂(k)), with d̂ = 0: what stands beside the disturbance
/// observers to show what they add. As with the IDOB, x̂(k) has seen y(0) … y(k−1).
class StateObserver : public DisturbanceEstimator {
 public:
  /// `poles` [1/s], continuous, n in all, one group per output, each stable. Throws
  /// std::invalid_argument if one is not, or they cannot be placed.
  StateObserver(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles,
                double period_s);

  void reset(const Vector& x) override { predictor_.reset(x); }
  void update(const Vector& held_input, const Vector& y) override {
    predictor_.update(held_input, y);
  }
  bool follow(const SampleInterval& interval) override {
    predictor_.over(interval.length_s);
    return true;
  }

  View state() const override { return {predictor_.state().data(), poles()}; }
  View disturbance() const override { return {disturbance_.data(), disturbance_.size()}; }
  std::span<const Signal> signals() const override { return signals_; }

  /// The poles are those of A − H C, which multiplies the estimation error at each sample.
  Eigen::Index poles() const override { return predictor_.state().size(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override {
    F = predictor_.error_dynamics();
  }

  const Eigen::MatrixXd& H() const { return predictor_.H(); }

 private:
  PolePredictor predictor_;
  Eigen::VectorXd disturbance_;  // 0
  std::vector<Signal> signals_;
};

}  // namespace breakwater
