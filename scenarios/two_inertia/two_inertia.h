// Scenario two_inertia: vibration control of a motor, a spring and a load.
#pragma once

#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

/// A motor turns a load through a spring, with an encoder on the motor. The question is how well a
/// controller moves the load, holds it under a torque, and reverses it through a backlash.
class TwoInertiaDrive final : public AxisScenario {
 public:
  explicit TwoInertiaDrive(const Catalogue& catalogue);

  std::string name() const override { return "two_inertia"; }
  std::string summary() const override {
    return "a motor and a load with a spring between them: vibration, load torque, backlash";
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return plant_.run; }
  AxisPlant plant() const override;
  AxisTask task() const override {
    return {.axis = plant_.nominal(), .reference = plant().axis().reference};
  }
  const AxisParts& parts() const override { return parts_; }

 private:
  enum class Kind { position_step, torque_step, reversal };

  AxisAdditions additions(const AxisRig& rig, const AxisLoop& loop) const override;
  /// Time of the reference's or the torque's last step.
  double last_step_s() const { return kind_ == Kind::reversal ? reversal_s_ : from_s_; }

  AxisPlant plant_;
  AxisParts parts_;
  Kind kind_ = Kind::position_step;
  double reference_rad_ = 0.0;
  double torque_Nm_ = 0.0;
  double from_s_ = 0.0;
  double reversal_s_ = 0.0;
  double window_from_s_ = 0.0;
  double settled_within_rad_ = 0.0;
};

}  // namespace breakwater
