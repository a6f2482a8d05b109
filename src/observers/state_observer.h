// A state observer without a disturbance model: case (b) of thesis 2.3.6.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/pole_predictor.h>

namespace breakwater {

/// x̂(k+1) = A x̂(k) + B u(k) + H (y(k) − C x̂(k)) with d̂ = 0, for comparison with the disturbance
/// observers. x̂(k) depends on y(0) … y(k−1), as with the IDOB.
class StateObserver : public DisturbanceEstimator {
 public:
  /// `poles` [1/s], continuous and stable: n in all, one group per output. Throws
  /// std::invalid_argument if a pole is not stable or the placement fails.
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
  Eigen::VectorXd disturbance_;  // always 0
  std::vector<Signal> signals_;
};

}  // namespace breakwater
