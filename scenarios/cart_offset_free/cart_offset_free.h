// Scenario cart_offset_free: predictive control under input and output disturbance (2.3.6, 3.3.3).
#pragma once

#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

/// The cart must go to a position and stay there, while a force pushes it and its position sensor
/// has an offset. Estimation is faster than control. The question is whether an error remains.
class CartOffsetFree final : public AxisScenario {
 public:
  explicit CartOffsetFree(const Catalogue& catalogue)
      : AxisScenario(catalogue, "cart_offset_free", Optimises::yes),
        plant_(cart_axis(), catalogue),
        parts_(catalogue, "mpc") {}

  std::string name() const override { return "cart_offset_free"; }
  std::string summary() const override {
    return "predictive control of a cart under input and output disturbance: the remaining error";
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
  AxisPlant plant_;
  AxisParts parts_;
  double disturbance_N_ = 0.0;
  double output_disturbance_m_ = 0.0;
  double disturbance_start_s_ = 0.0;
  bool noise_ = false;
  double from_s_ = 0.0;
  double settled_within_ = 0.0;
};

}  // namespace breakwater
