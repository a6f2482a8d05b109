// Scenario cart_estimation: disturbance models and forgetting factors (thesis 4.2.4).
#pragma once

#include <breakwater/control/reference.h>
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/world/disturbance.h>

namespace breakwater {

/// A cart under PD control with disturbance cancellation (Eq. 4.10), with system and observation
/// noise. The question is which disturbance model and forgetting factor follow which disturbance,
/// how fast, and with how much noise.
class CartEstimation final : public AxisScenario {
 public:
  explicit CartEstimation(const Catalogue& catalogue);

  std::string name() const override { return "cart_estimation"; }
  std::string summary() const override {
    return "disturbance models and forgetting factors of Kalman filters on a cart";
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  AxisPlant plant() const override;
  AxisTask task() const override {
    return {.axis = plant().nominal(), .reference = plant_.axis().reference};
  }
  const AxisParts& parts() const override { return parts_; }

 private:
  enum class Kind { step, ramp, sine, high_sine };

  Disturbance disturbance() const;

  AxisAdditions additions(const AxisRig& rig, const AxisLoop& loop) const override;

  AxisPlant plant_;
  AxisParts parts_;
  Kind kind_ = Kind::step;
  Disturbance step_{.kind = DisturbanceKind::step};
  Disturbance ramp_{.kind = DisturbanceKind::ramp};
  Disturbance sine_{.kind = DisturbanceKind::sine};
  Disturbance high_sine_{.kind = DisturbanceKind::sine};
  double from_s_ = 0.0;
  double noise_from_s_ = 0.0;
  double noise_to_s_ = 0.0;
};

}  // namespace breakwater
