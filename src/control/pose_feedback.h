// State feedback of a plant with several axes about a pose.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/control/controller.h>
#include <breakwater/control/reference.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/signals/axis_units.h>

namespace breakwater {

/// One output of a plant for state feedback: the position of an axis.
struct FeedbackAxis {
  std::string name;  ///< its signals are NAME_…
  AxisUnits units;
  Reference reference;    ///< the output's; it begins at the pose
  bool is_driven = true;  ///< the driven axes are the inputs, in the same order
};

struct PoseFeedbackDesign {
  StateSpace plant;                ///< x = [deviations from the pose; rates], p outputs
  Eigen::MatrixXd to_states;       ///< n×p: the states at rest at given outputs
  Eigen::MatrixXd K;               ///< m×n
  Eigen::VectorXd pose;            ///< the outputs at the pose (p)
  Eigen::VectorXd held_input;      ///< u_0 that holds the pose (m)
  Eigen::VectorXd limit;           ///< limit of each input (m); infinity: none
  std::vector<FeedbackAxis> axes;  ///< one for each output (p)
};

/// u = u_0 − K (x̂ − x_ref) + d̂. The estimator sees deviations from the pose, and gets u after the
/// limits. Expects the measured outputs as the first entries of a sample.
class PoseFeedback final : public Controller {
 public:
  /// Throws std::invalid_argument unless the estimator is for the same plant.
  PoseFeedback(std::shared_ptr<DisturbanceEstimator> estimator, PoseFeedbackDesign design);

  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override;

 private:
  std::shared_ptr<DisturbanceEstimator> estimator_;
  PoseFeedbackDesign design_;
  Eigen::VectorXd y_;      // deviation from the pose
  Eigen::VectorXd error_;  // x̂ − x_ref
  Eigen::VectorXd position_hat_;
  Eigen::VectorXd held_input_;
};

}  // namespace breakwater
