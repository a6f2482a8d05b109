#include "arm_wall_contact/wall_contact_metrics.h"

#include <algorithm>
#include <cmath>

namespace breakwater {
namespace {

constexpr double kImpulseWindow_s = 0.2;

}  // namespace

bool WallContactMetrics::after_step(double time_s, double force_N, double filtered_N,
                                    double tip_speed_x_m_s) {
  if (!counts(time_s)) return false;
  const bool strikes = follow_contact(time_s, force_N, tip_speed_x_m_s);
  peak_raw_N_ = std::max(peak_raw_N_, force_N);
  peak_filtered_N_ = std::max(peak_filtered_N_, filtered_N);
  if (in_error_window(time_s)) error_N_.add(window_.reference_N - filtered_N);
  return strikes;
}

void WallContactMetrics::after_sample(double time_s, double force_N, const TipPose& tip,
                                      bool saturated) {
  if (!counts(time_s)) return;
  if (saturated) saturated_s_ += window_.period_s;
  if (in_error_window(time_s)) {
    ++samples_;
    follow_late_force(time_s, force_N);
    saturated_samples_ += saturated ? 1 : 0;
  }
  const TipPose error = tip - window_.start_pose;
  max_y_error_m_ = std::max(max_y_error_m_, std::abs(error[1]));
  max_posture_error_rad_ = std::max(max_posture_error_rad_, std::abs(error[2]));
}

bool WallContactMetrics::follow_contact(double time_s, double force_N, double tip_speed_x_m_s) {
  const bool touches = force_N > 0.0;
  bool strikes = false;
  if (touches && !touched_) {
    ++onsets_;
    if (!first_contact_s_) {
      strikes = true;
      first_contact_s_ = time_s;
      impact_velocity_m_s_ = tip_speed_x_m_s;
    }
  }
  touched_ = touches;
  if (first_contact_s_ && time_s < *first_contact_s_ + kImpulseWindow_s - 0.5 * window_.step_s) {
    impulse_Ns_ += force_N * window_.step_s;
  }
  return strikes;
}

void WallContactMetrics::follow_late_force(double time_s, double force_N) {
  const double fifth_s = (window_.error_to_s - window_.error_from_s) / 5.0;
  const double half_step_s = 0.5 * window_.step_s;
  if (time_s < window_.error_from_s + fifth_s - half_step_s) first_fifth_N_.add(force_N);
  if (time_s >= window_.error_to_s - fifth_s - half_step_s) last_fifth_N_.add(force_N);
  if (last_late_force_N_) {
    if (force_N > 0.0 && *last_late_force_N_ <= 0.0) ++late_onsets_;
    if (force_N > window_.reference_N && *last_late_force_N_ <= window_.reference_N) ++rises_;
  }
  last_late_force_N_ = force_N;
}

void WallContactMetrics::add_late_force(std::vector<Metric>& list) const {
  list.push_back({"late_bounce_count", "1", static_cast<double>(late_onsets_)});
  const std::optional<double> first_N = first_fifth_N_.standard_deviation();
  const std::optional<double> last_N = last_fifth_N_.standard_deviation();
  if (first_N && last_N && *first_N > 0.0) {
    list.push_back({"force_decay_ratio", "1", *last_N / *first_N});
  }
  list.push_back({"force_frequency_Hz", "Hz",
                  static_cast<double>(rises_) / (window_.error_to_s - window_.error_from_s)});
}

std::vector<MetricDefinition> WallContactMetrics::definitions() {
  return {
      {"free_motion_time_s", "s", "time from the switch to force control until the first contact"},
      {"peak_force_raw_N", "N", "largest contact force, at the physics rate"},
      {"peak_force_filtered_N", "N",
       "largest force behind the sensor's low-pass, at the physics rate"},
      {"mean_force_error_N", "N",
       "mean of reference minus filtered force, from metrics.from_s to metrics.to_s"},
      {"std_force_error_N", "N", "standard deviation of the same error in the same window"},
      {"saturated_share", "1",
       "share of the samples in the window at which any command is at its limit"},
      {"late_bounce_count", "1", "number of contact onsets in the window, counted at the samples"},
      {"force_decay_ratio", "1",
       "standard deviation of the contact force in the window's last fifth over that in its first "
       "fifth. Below 1 the contact still settles; 1 means a limit cycle"},
      {"force_frequency_Hz", "Hz",
       "number of times per second that the contact force rises above the reference, counted at "
       "the samples"},
      {"impact_velocity_m_s", "m/s", "speed of the tip along x at the first contact"},
      {"impact_mass_kg", "kg",
       "effective mass of the arm along x at the first contact, with every joint free to recoil"},
      {"contact_impulse_Ns", "N s",
       "integral of the contact force over the first 0.2 s after the first contact"},
      {"bounce_count", "1", "number of contact onsets after the first"},
      {"saturated_time_s", "s", "time for which any command is at its limit, from the switch"},
      {"max_posture_error_rad", "rad",
       "largest deviation of the tip's orientation from the start pose, from the switch"},
      {"max_y_error_m", "m",
       "largest deviation of the tip's y from the start pose, from the switch"}};
}

std::vector<Metric> WallContactMetrics::metrics(double simulated_s) const {
  std::vector<Metric> list;
  if (simulated_s <= window_.force_from_s) return list;
  if (first_contact_s_) {
    list.push_back({"free_motion_time_s", "s", *first_contact_s_ - window_.force_from_s});
    list.push_back({"peak_force_raw_N", "N", peak_raw_N_});
    list.push_back({"peak_force_filtered_N", "N", peak_filtered_N_});
  }
  if (simulated_s >= window_.error_to_s - 0.5 * window_.step_s && error_N_.count() > 1) {
    list.push_back({"mean_force_error_N", "N", error_N_.mean()});
    list.push_back({"std_force_error_N", "N", *error_N_.standard_deviation()});
    if (samples_ > 0) {
      list.push_back({"saturated_share", "1",
                      static_cast<double>(saturated_samples_) / static_cast<double>(samples_)});
    }
    if (first_contact_s_) add_late_force(list);
  }
  if (first_contact_s_) {
    list.push_back({"impact_velocity_m_s", "m/s", impact_velocity_m_s_});
    list.push_back({"impact_mass_kg", "kg", impact_mass_kg_});
    if (simulated_s >= *first_contact_s_ + kImpulseWindow_s) {
      list.push_back({"contact_impulse_Ns", "N s", impulse_Ns_});
    }
    list.push_back({"bounce_count", "1", static_cast<double>(onsets_ - 1)});
  }
  list.push_back({"saturated_time_s", "s", saturated_s_});
  list.push_back({"max_posture_error_rad", "rad", max_posture_error_rad_});
  list.push_back({"max_y_error_m", "m", max_y_error_m_});
  return list;
}

}  // namespace breakwater
