// Scenario motor_estimation: disturbance estimators behind an encoder (thesis 4.3).
#pragma once

#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/disturbance_settings.h>

namespace breakwater {

/// PD control with disturbance cancellation (Eq. 4.22) holds a motor at 0. Its angle comes from an
/// encoder, with or without white noise, and a torque disturbs it. The question is how well the
/// estimator finds velocity and disturbance.
class MotorEstimation final : public AxisScenario {
 public:
  explicit MotorEstimation(const Catalogue& catalogue)
      : AxisScenario(catalogue, "motor_estimation"),
        plant_(motor_axis(), catalogue),
        parts_(catalogue, "pd") {}

  std::string name() const override { return "motor_estimation"; }
  std::string summary() const override {
    return "disturbance estimators on a motor: encoder quantisation and white noise";
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  AxisPlant plant() const override;
  AxisTask task() const override { return {.axis = plant_.nominal()}; }
  const AxisParts& parts() const override { return parts_; }

 private:
  AxisAdditions additions(const AxisRig& rig, const AxisLoop& loop) const override;

  AxisPlant plant_;
  AxisParts parts_;
  DisturbanceSettings disturbance_;
  double from_s_ = 0.0;
  double settled_within_ = 0.0;
};

}  // namespace breakwater
