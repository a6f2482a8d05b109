// Predictive control with an estimator: the thesis' controllers of 2.3 and 3.3.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/control/lmpc.h>
#include <breakwater/control/reference.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/signals/axis_units.h>

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
  Reference reference;          ///< reference of the position
  Eigen::VectorXd start_state;  ///< x̂(0), n
  double force_limit = std::numeric_limits<double>::infinity();  ///< limit of the drive
  Eigen::Index controlled = 0;  ///< the state that follows the reference
  AxisUnits units = translation_units();
};

/// Linear predictive control of one input, with an estimator of state and disturbance.
///
/// With DisturbanceUse::predict the model is an ExtendedPlant of order 0 (Eq. 2.46).
///
/// The reference of the state is r for the controlled state and 0 for all others, constant over the
/// horizon.
/// The estimator gets the commanded input after the drive's limit.
///
/// Expects the measured position as the first entry of a sample.
class PredictiveControl final : public Controller {
 public:
  /// Throws std::invalid_argument if the sizes of the estimator, the model and the design differ.
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
  Eigen::VectorXd cancelled_;      // d̂, which is added to it
  Eigen::VectorXd held_input_;     // the command after the drive's limit
  double iterations_ = 0.0;
  double softened_ = 0.0;
  double status_ = 0.0;
  double kkt_residual_ = 0.0;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
