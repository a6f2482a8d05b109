// The metrics of an impact.
#pragma once

#include <optional>
#include <vector>

#include <breakwater/record/metric_definition.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// A physics step of an impact: values at its beginning, and its impulse.
struct ImpactStep {
  double force_N = 0.0;
  double filtered_N = 0.0;
  double penetration_m = 0.0;
  double approach_m_s = 0.0;  ///< the penetration's rate
  double impulse_Ns = 0.0;    ///< by the integrator's own stages
};

/// Gathers the metrics of impact_test, step by step: definitions() has them. A metric of the first
/// contact is absent until that contact has ended.
class ImpactMetrics {
 public:
  explicit ImpactMetrics(double step_s) : step_s_(step_s) {}

  void after_step(const ImpactStep& step);

  static std::vector<MetricDefinition> definitions();
  std::vector<Metric> metrics() const;

 private:
  bool is_first_contact() const { return onsets_ == 1 && touches_; }

  double step_s_;
  int onsets_ = 0;
  bool touches_ = false;
  double speed_in_m_s_ = 0.0;
  std::optional<double> speed_out_m_s_;  // once the first contact has ended
  double contact_time_s_ = 0.0;
  double impulse_Ns_ = 0.0;
  double peak_raw_N_ = 0.0;
  double peak_filtered_N_ = 0.0;
  double deepest_m_ = 0.0;
};

}  // namespace breakwater
