// Scenario cart_position: a cart with friction, drive and encoder (thesis 2.3.4, 4.2.5).
#pragma once

#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

/// A cart with Coulomb and viscous friction, a drive of finite pulse-width resolution and an
/// encoder goes to a position. Its control is PD with disturbance cancellation (Eq. 4.10) or
/// predictive control. The nominal model lacks the friction, so the estimator must find it.
class CartPosition final : public AxisScenario {
 public:
  explicit CartPosition(const Catalogue& catalogue)
      : AxisScenario(catalogue, "cart_position", Optimises::yes),
        plant_(cart_axis(), catalogue),
        parts_(catalogue, "") {}

  std::string name() const override { return "cart_position"; }
  std::string summary() const override {
    return "position control of a cart with friction, quantised drive and encoder";
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  AxisPlant plant() const override { return plant_; }
  AxisTask task() const override {
    return {.axis = plant().nominal(), .reference = plant_.axis().reference};
  }
  const AxisParts& parts() const override { return parts_; }

 private:
  AxisAdditions additions(const AxisRig& rig, const AxisLoop& loop) const override;

  AxisPlant plant_;
  AxisParts parts_;
  double from_s_ = 0.0;
  double settled_within_ = 0.0;
  double high_pass_Hz_ = 0.0;
};

}  // namespace breakwater
