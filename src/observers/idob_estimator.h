// The identity disturbance observer (IDOB) as a disturbance estimator.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/idob.h>

namespace breakwater {

/// An IDOB between whose samples a controller stands: its estimate at sample k is the predictor's,
/// and has seen y(0) … y(k−1).
class IdobEstimator final : public DisturbanceEstimator {
 public:
  /// Throws std::invalid_argument as Idob does.
  IdobEstimator(const StateSpace& continuous_plant, const std::vector<PoleGroup>& poles,
                double period_s);

  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;
  bool follow(const SampleInterval& interval) override;

  View state() const override { return {idob_.extended_state().data(), plant_states_}; }
  View disturbance() const override {
    return {idob_.extended_state().data() + plant_states_, poles() - plant_states_};
  }
  std::span<const Signal> signals() const override { return signals_; }

  Eigen::Index poles() const override { return idob_.error_dynamics().rows(); }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override { F = idob_.error_dynamics(); }

 private:
  Idob idob_;
  Eigen::Index plant_states_;
  Eigen::MatrixXd C_;
  bool has_begun_ = false;
  Eigen::VectorXd last_output_;
  Eigen::VectorXd innovation_;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
