// Predictive control with an estimator inside: the thesis' controllers of 2.3 and 3.3.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/control/lmpc.h>
#include <breakwater/control/step_reference.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// What the controller does with the estimated disturbance.
enum class DisturbanceUse {
  none,     ///< nothing
  predict,  ///< it is a state of the prediction model (Eqs. 2.46–2.48, 3.12): the proposed method
  cancel,   ///< ũ = u + d̂ (Eq. 2.45); u alone is bounded
  /// The same, and u_low − d̂ ≤ u ≤ u_upp − d̂: the second remedy of 2.3.4. d̂ moves between two
  /// optimisations; there ũ is clipped to [u_low, u_upp].
  cancel_within_bounds
};

/// When the estimate that is cancelled is taken anew.
enum class CancelAt { sample, decision };

struct PredictiveControlDesign {
  LmpcDesign lmpc;  ///< its A and B are the extended model's with DisturbanceUse::predict
  DisturbanceUse disturbance_use = DisturbanceUse::predict;
  CancelAt cancel_at = CancelAt::sample;
  int samples_per_move = 1;  ///< the estimator runs at every sample, the optimisation at every …th
  StepReference reference;   ///< of the position
  Eigen::VectorXd start_state;                                   ///< x̂(0), n
  double force_limit = std::numeric_limits<double>::infinity();  ///< of the drive
};

/// One input, of which an estimator knows state and disturbance, and linear predictive control.
///
/// With DisturbanceUse::predict the model is ExtendedPlant's, of order 0 (Eq. 2.46).
///
/// The tracked state is [position; …], its reference (r, 0, …, 0) over the whole horizon. The
/// estimator is told of the input that is asked for, as the drive's limit clips it.
///
/// Expects samples whose first entry is the measured position.
class PredictiveControl final : public Controller {
 public:
  /// Throws std::invalid_argument if the estimator, the model and the design do not fit.
  PredictiveControl(std::shared_ptr<DisturbanceEstimator> estimator,
                    const PredictiveControlDesign& design);

  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override;
  std::span<const Signal> signals() const override { return signals_; }

  const DisturbanceEstimator& estimator() const { return *estimator_; }
  const Lmpc& lmpc() const { return lmpc_; }

 private:
  std::shared_ptr<DisturbanceEstimator> estimator_;
  PredictiveControlDesign design_;
  Lmpc lmpc_;
  Eigen::Index plant_states_;
  int samples_to_move_ = 0;
  double reference_ = 0.0;
  Eigen::VectorXd predicted_state_;  // x̂, or x̄
  Eigen::VectorXd trajectory_;       // T_ref
  Eigen::VectorXd reserved_;
  Eigen::VectorXd planned_input_;  // u of the optimisation
  Eigen::VectorXd cancelled_;      // the d̂ that is added to it
  Eigen::VectorXd held_input_;     // what is asked for, as the drive clips it
  double iterations_ = 0.0;
  double softened_ = 0.0;
  double status_ = 0.0;
  double kkt_residual_ = 0.0;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
