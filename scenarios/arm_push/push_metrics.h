// What the recovery from a push is judged by.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include <breakwater/plants/planar_chain.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/window_metrics.h>

namespace breakwater {

/// Which part of a run is judged, and against what.
struct PushWindow {
  double grip_s = 0.0;  ///< everything counts from here
  double release_s = 0.0;
  std::vector<double> start_angles_rad;
  TipPose start_pose = TipPose::Zero();
  double settled_within_m = 0.0;
  double period_s = 0.0;
};

/// Gathers the metrics of arm_push, sample by sample:
///  - max_push_rad: how far the hand turned the link, before it let go;
///  - overshoot_rad: the largest joint excursion past the start, on the other side of where the
///    joint was let go; or, where the tip comes back in another posture, how far a joint is off;
///  - x_overshoot_m, y_overshoot_m, posture_overshoot_rad: the same of the tip's pose, each
///    coordinate past its start, in whatever posture;
///  - reversal_count: how often the joint that swings most turns back by more than 0.02 rad after
///    the release;
///  - settling_time_s: from the release until the tip stays within settled_within_m; absent if it
///    never does;
///  - saturated_time_s: how long any command was at its limit, from the grip;
///  - tip_error_m: the tip's distance from its start at the end;
///  - peak_speed_rad_s: of any joint, after the release.
/// Those after the release are absent if the run ends before it.
class PushMetrics {
 public:
  explicit PushMetrics(const PushWindow& window)
      : window_(window),
        release_offsets_(window.start_angles_rad.size(), 0.0),
        reversals_(window.start_angles_rad.size(), ReversalCount(kTurn_rad)) {}

  void after_sample(double time_s, const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                    const TipPose& tip, double turned_rad, bool saturated);

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
  double last_offset_rad_ = 0.0;  // the largest of any joint
  TipPose release_tip_offset_ = TipPose::Zero();
  TipPose tip_overshoot_ = TipPose::Zero();
  double saturated_s_ = 0.0;
  double tip_error_m_ = 0.0;
  double peak_speed_rad_s_ = 0.0;
  double unsettled_until_s_ = 0.0;
};

}  // namespace breakwater
