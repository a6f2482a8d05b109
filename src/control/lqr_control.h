// The linear quadratic regulator, with or without an estimator: the baselines of thesis 2.3.7.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/observers/disturbance_estimator.h>

namespace breakwater {

/// u(k) = −K x̂(k) + d̂(k), or u(k) = −K x(k) with the true state and no estimate of d.
///
/// Expects samples with the measured position, followed by the true state (n).
class LqrControl final : public Controller {
 public:
  /// The estimator also runs with the true state, so that a log has its estimates. It gets u after
  /// the drive's limit. `K` is 1×n; the estimator starts at `start_state` (n). Throws
  /// std::invalid_argument if the sizes do not fit or the limit is not positive.
  LqrControl(std::shared_ptr<DisturbanceEstimator> estimator, Eigen::RowVectorXd K,
             Eigen::VectorXd start_state, bool uses_true_state,
             double force_limit = std::numeric_limits<double>::infinity());

  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override;
  std::span<const Signal> signals() const override { return signals_; }

  const DisturbanceEstimator& estimator() const { return *estimator_; }

 private:
  std::shared_ptr<DisturbanceEstimator> estimator_;
  Eigen::RowVectorXd K_;
  Eigen::VectorXd start_state_;
  bool uses_true_state_;
  double force_limit_;
  Eigen::VectorXd held_input_;
  std::vector<Signal> signals_;
};

}  // namespace breakwater
