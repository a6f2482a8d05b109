#include "impact_test/impact_metrics.h"

#include <algorithm>

namespace breakwater {

void ImpactMetrics::after_step(const ImpactStep& step) {
  peak_raw_N_ = std::max(peak_raw_N_, step.force_N);
  peak_filtered_N_ = std::max(peak_filtered_N_, step.filtered_N);
  deepest_m_ = std::max(deepest_m_, step.penetration_m);
  const bool touched = touches_;
  // The impulse, because the contact may begin at a later stage of a step.
  touches_ = step.impulse_Ns > 0.0;
  if (touches_ && !touched) {
    ++onsets_;
    if (onsets_ == 1) speed_in_m_s_ = step.approach_m_s;
  }
  if (!touches_ && touched && onsets_ == 1) speed_out_m_s_ = -step.approach_m_s;
  if (!is_first_contact()) return;
  impulse_Ns_ += step.impulse_Ns;
  if (step.force_N > 0.0) contact_time_s_ += step_s_;
}

std::vector<MetricDefinition> ImpactMetrics::definitions() {
  return {
      {"peak_force_raw_N", "N", "largest contact force, at the physics rate"},
      {"peak_force_filtered_N", "N",
       "largest force behind the sensor's low-pass, at the physics rate"},
      {"contact_time_s", "s", "duration of the whole first contact"},
      {"restitution", "1",
       "speed of separation after the first contact over the speed of approach before it, both "
       "along the wall's normal and relative to the wall"},
      {"contact_impulse_Ns", "N s",
       "integral of the contact force over the whole first contact, by the integrator's stages"},
      {"penetration_m", "m", "largest penetration"},
      {"bounce_count", "1", "number of contact onsets after the first"}};
}

std::vector<Metric> ImpactMetrics::metrics() const {
  std::vector<Metric> list;
  if (onsets_ == 0) return list;
  list.emplace_back("peak_force_raw_N", "N", peak_raw_N_);
  list.emplace_back("peak_force_filtered_N", "N", peak_filtered_N_);
  if (speed_out_m_s_) {
    list.emplace_back("contact_time_s", "s", contact_time_s_);
    if (speed_in_m_s_ > 0.0) {
      list.emplace_back("restitution", "1", *speed_out_m_s_ / speed_in_m_s_);
    }
    list.emplace_back("contact_impulse_Ns", "N s", impulse_Ns_);
  }
  list.emplace_back("penetration_m", "m", deepest_m_);
  list.emplace_back("bounce_count", "1", static_cast<double>(onsets_ - 1));
  return list;
}

}  // namespace breakwater
