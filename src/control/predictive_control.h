// Predictive control with an estimator: the thesis' controllers of 2.3 and 3.3.
#pragma once

#include <Eigen/Core>
#include <memory>

#include <breakwater/control/estimating_control.h>
#include <breakwater/control/lmpc.h>

namespace breakwater {

/// The controller's use of the estimated disturbance.
enum class DisturbanceUse {
  none,     ///< nothing
  predict,  ///< it is a state of the prediction model (Eqs. 2.46–2.48, 3.12): the proposed method
  cancel,   ///< ũ = u + d̂ (Eq. 2.45); u alone is bounded
  /// The same with u_low − d̂ ≤ u ≤ u_upp − d̂: the second remedy of 2.3.4. d̂ changes between two
  /// optimisations, and ũ is then clipped to [u_low, u_upp].
  cancel_within_bounds
};

/// When the cancelled estimate is updated.
enum class CancelAt { sample, decision };

struct PredictiveControlDesign {
  LmpcDesign lmpc;  ///< DisturbanceUse::predict: A and B of the extended model
  DisturbanceUse disturbance_use = DisturbanceUse::predict;
  CancelAt cancel_at = CancelAt::sample;
  int samples_per_move = 1;     ///< samples from one optimisation to the next
  Eigen::Index controlled = 0;  ///< the state that follows the reference
  AxisLoopDesign loop;
};

/// Linear predictive control of one input, with an estimator of state and disturbance.
///
/// With DisturbanceUse::predict the model is an ExtendedPlant of order 0 (Eq. 2.46).
///
/// The reference of the state is r for the controlled state and 0 for all others, constant over the
/// horizon.
class PredictiveControl final : public EstimatingControl {
 public:
  /// Throws std::invalid_argument as EstimatingControl does, and if the sizes of the estimator, the
  /// model and the design differ.
  PredictiveControl(std::shared_ptr<DisturbanceEstimator> estimator,
                    const PredictiveControlDesign& design);

  void reset(const Sample& first) override;

  const Lmpc& lmpc() const { return lmpc_; }

 private:
  double input(const Sample& y) override;

  PredictiveControlDesign design_;
  Lmpc lmpc_;
  std::int64_t sample_ = 0;
  Eigen::VectorXd predicted_state_;  // x̂, or x̄
  double cancelled_ = 0.0;           // d̂, which is added to the input
  double status_ = 0.0;
};

}  // namespace breakwater
