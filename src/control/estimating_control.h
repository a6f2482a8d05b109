// The loop of one axis whose controller has an estimator.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>

#include <breakwater/control/controller.h>
#include <breakwater/control/reference.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/observer_poles.h>
#include <breakwater/signals/axis_units.h>

namespace breakwater {

/// The part of a design that all these controllers share.
struct AxisLoopDesign {
  Reference reference;                                           ///< r
  double force_limit = std::numeric_limits<double>::infinity();  ///< limit of the drive
  double period_s = 0.0;                                         ///< T_s; 0: the log has no poles
  AxisUnits units = translation_units();
  Eigen::VectorXd start_state = Eigen::Vector2d::Zero();  ///< x̂(0), n
};

/// A control law of one input. It uses the estimates of the same sample. The estimator gets u after
/// the drive's force limit. All other effects of the drive are part of d̂.
///
/// Expects the measured position as the first entry of a sample.
class EstimatingControl : public Controller {
 public:
  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) final;
  /// Without a reader, the estimator's poles are not computed.
  void set_watched(bool is_watched) override { is_watched_ = is_watched; }

  const DisturbanceEstimator& estimator() const { return *estimator_; }

 protected:
  /// Throws std::invalid_argument unless the limit is positive and the estimator has one input and
  /// the states of the start.
  EstimatingControl(std::shared_ptr<DisturbanceEstimator> estimator, const AxisLoopDesign& design);

  /// u(k), from the new estimates.
  virtual double input(const Sample& y) = 0;
  double reference() const { return reference_; }
  DisturbanceEstimator::View state() const { return estimator_->state(); }
  double disturbance() const { return estimator_->disturbance()(0); }

 private:
  std::shared_ptr<DisturbanceEstimator> estimator_;
  AxisLoopDesign design_;
  std::optional<ObserverPoles> poles_;
  bool is_watched_ = true;
  double reference_ = 0.0;
  Eigen::VectorXd held_input_ = Eigen::VectorXd::Zero(1);
};

}  // namespace breakwater
