// The metrics of the recovery from a push.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include <breakwater/plants/planar_chain.h>
#include <breakwater/record/metric_definition.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/window_metrics.h>

namespace breakwater {

/// The times and reference values of the metrics.
struct PushWindow {
  double grip_s = 0.0;  ///< beginning of all metrics
  double release_s = 0.0;
  std::vector<double> start_angles_rad;
  TipPose start_pose = TipPose::Zero();
  double settled_within_m = 0.0;
  double period_s = 0.0;
};

/// Collects the metrics of arm_push (see definitions()), step by step. Metrics after the release
/// are absent if the run ends before it.
class PushMetrics {
 public:
  explicit PushMetrics(const PushWindow& window)
      : window_(window),
        release_offsets_(window.start_angles_rad.size(), 0.0),
        reversals_(window.start_angles_rad.size(), ReversalCount(kTurn_rad)) {}

  void after_sample(double time_s, const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                    const TipPose& tip, double turned_rad, bool saturated);

  static std::vector<MetricDefinition> definitions();
  std::vector<Metric> metrics() const;

 private:
  static constexpr double kTurn_rad = 0.02;
  static constexpr double kOtherPosture_rad = 0.2;

  bool has_settled() const { return unsettled_until_s_ <= *last_free_s_; }
  double offset_rad(const Eigen::VectorXd& q, std::size_t joint) const {
    return q(static_cast<Eigen::Index>(joint)) - window_.start_angles_rad[joint];
  }

  PushWindow window_;
  std::vector<double> release_offsets_;
  std::vector<ReversalCount> reversals_;
  std::optional<double> max_push_rad_;
  std::optional<double> last_free_s_;  // the last sample after the release
  double overshoot_rad_ = 0.0;
  double last_offset_rad_ = 0.0;  // largest of all joints
  TipPose release_tip_offset_ = TipPose::Zero();
  TipPose tip_overshoot_ = TipPose::Zero();
  double saturated_s_ = 0.0;
  double tip_error_m_ = 0.0;
  double peak_speed_rad_s_ = 0.0;
  double unsettled_until_s_ = 0.0;
};

}  // namespace breakwater
