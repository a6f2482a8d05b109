#include "arm_push/push_metrics.h"

#include <algorithm>
#include <cmath>

namespace breakwater {

void PushMetrics::after_sample(double time_s, const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                               const TipPose& tip, double turned_rad, bool saturated) {
  if (time_s < window_.grip_s) return;
  if (saturated) saturated_s_ += window_.period_s;
  const TipPose tip_offset = tip - window_.start_pose;
  tip_error_m_ = tip_offset.head<2>().norm();
  if (time_s < window_.release_s) {
    max_push_rad_ = std::max(max_push_rad_.value_or(0.0), std::abs(turned_rad));
    for (std::size_t i = 0; i < release_offsets_.size(); ++i)
      release_offsets_[i] = offset_rad(q, i);
    release_tip_offset_ = tip_offset;
    return;
  }
  tip_overshoot_ =
      tip_overshoot_.cwiseMax(-release_tip_offset_.cwiseSign().cwiseProduct(tip_offset));
  last_offset_rad_ = 0.0;
  for (std::size_t i = 0; i < release_offsets_.size(); ++i) {
    last_offset_rad_ = std::max(last_offset_rad_, std::abs(offset_rad(q, i)));
    overshoot_rad_ =
        std::max(overshoot_rad_, -std::copysign(1.0, release_offsets_[i]) * offset_rad(q, i));
    reversals_[i].add(offset_rad(q, i));
  }
  peak_speed_rad_s_ = std::max(peak_speed_rad_s_, dq.cwiseAbs().maxCoeff());
  if (tip_error_m_ > window_.settled_within_m) unsettled_until_s_ = time_s + window_.period_s;
  last_free_s_ = time_s;
}

std::vector<MetricDefinition> PushMetrics::definitions() {
  return {
      {"max_push_rad", "rad", "largest angle by which the hand turned the link before it let go"},
      {"overshoot_rad", "rad",
       "largest joint excursion past the start angle, on the other side of the release. If the tip "
       "settles in another posture, the largest joint offset at the end counts too"},
      {"x_overshoot_m", "m",
       "largest excursion of the tip's x past its start, on the other side of the release"},
      {"y_overshoot_m", "m",
       "largest excursion of the tip's y past its start, on the other side of the release"},
      {"posture_overshoot_rad", "rad",
       "largest excursion of the tip's orientation past its start, on the other side of the "
       "release"},
      {"reversal_count", "1",
       "number of times that the joint that swings most turns back by more than 0.02 rad after the "
       "release"},
      {"settling_time_s", "s",
       "time from the release until the tip stays within metrics.settled_within_m of its start; "
       "absent if it never does"},
      {"saturated_time_s", "s", "time for which any command is at its limit, from the grip"},
      {"tip_error_m", "m", "distance of the tip from its start at the end of the run"},
      {"peak_speed_rad_s", "rad/s", "largest speed of any joint after the release"}};
}

std::vector<Metric> PushMetrics::metrics() const {
  std::vector<Metric> list;
  if (max_push_rad_) list.push_back({"max_push_rad", "rad", *max_push_rad_});
  if (!last_free_s_) return list;
  const bool is_otherwise = has_settled() && last_offset_rad_ > kOtherPosture_rad;
  list.push_back({"overshoot_rad", "rad",
                  is_otherwise ? std::max(overshoot_rad_, last_offset_rad_) : overshoot_rad_});
  list.push_back({"x_overshoot_m", "m", tip_overshoot_[0]});
  list.push_back({"y_overshoot_m", "m", tip_overshoot_[1]});
  list.push_back({"posture_overshoot_rad", "rad", tip_overshoot_[2]});
  int reversals = 0;
  for (const ReversalCount& joint : reversals_) reversals = std::max(reversals, joint.value());
  list.push_back({"reversal_count", "1", static_cast<double>(reversals)});
  if (has_settled()) {
    list.push_back({"settling_time_s", "s", std::max(unsettled_until_s_ - window_.release_s, 0.0)});
  }
  list.push_back({"saturated_time_s", "s", saturated_s_});
  list.push_back({"tip_error_m", "m", tip_error_m_});
  list.push_back({"peak_speed_rad_s", "rad/s", peak_speed_rad_s_});
  return list;
}

}  // namespace breakwater
