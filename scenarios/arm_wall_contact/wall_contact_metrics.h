// The metrics of a contact with the wall.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <breakwater/plants/planar_chain.h>
#include <breakwater/record/metric_definition.h>
#include <breakwater/record/recording.h>
#include <breakwater/record/window_metrics.h>

namespace breakwater {

/// The times of the metrics.
struct WallContactWindow {
  double force_from_s = 0.0;  ///< the switch to force control: the beginning of all metrics
  double reference_N = 0.0;
  double error_from_s = 0.0;  ///< beginning of the force error's window ...
  double error_to_s = 0.0;    ///< ... and its end, which is not included
  double step_s = 0.0;
  double period_s = 0.0;
  TipPose start_pose = TipPose::Zero();
};

/// Collects the metrics of arm_wall_contact (see definitions()), step by step. A metric that does
/// not apply (no contact, a run that is too short) is absent.
class WallContactMetrics {
 public:
  explicit WallContactMetrics(const WallContactWindow& window) : window_(window) {}

  /// Call it at every physics step, with the values at its beginning. Returns whether it is the
  /// first contact.
  bool after_step(double time_s, double force_N, double filtered_N, double tip_speed_x_m_s);
  /// Call it at the first contact.
  void set_impact_mass(double mass_kg) { impact_mass_kg_ = mass_kg; }
  /// Call it at every sample.
  void after_sample(double time_s, double force_N, const TipPose& tip, bool saturated);

  static std::vector<MetricDefinition> definitions();
  std::vector<Metric> metrics(double simulated_s) const;

 private:
  bool counts(double time_s) const { return time_s >= window_.force_from_s - 0.5 * window_.step_s; }
  bool in_error_window(double time_s) const {
    const double half_step = 0.5 * window_.step_s;
    return time_s >= window_.error_from_s - half_step && time_s < window_.error_to_s - half_step;
  }
  bool follow_contact(double time_s, double force_N, double tip_speed_x_m_s);
  void follow_late_force(double time_s, double force_N);
  void add_late_force(std::vector<Metric>& list) const;

  WallContactWindow window_;
  std::optional<double> first_contact_s_;
  bool touched_ = false;
  int onsets_ = 0;
  double impact_velocity_m_s_ = 0.0;
  double impact_mass_kg_ = 0.0;
  double impulse_Ns_ = 0.0;
  double peak_raw_N_ = 0.0;
  double peak_filtered_N_ = 0.0;
  RunningVariance error_N_;  // force error in the window
  double saturated_s_ = 0.0;
  RunningVariance first_fifth_N_;
  RunningVariance last_fifth_N_;
  std::optional<double> last_late_force_N_;
  int late_onsets_ = 0;
  int rises_ = 0;
  std::int64_t samples_ = 0;  // in the window
  std::int64_t saturated_samples_ = 0;
  double max_y_error_m_ = 0.0;
  double max_posture_error_rad_ = 0.0;
};

}  // namespace breakwater
