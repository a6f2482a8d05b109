// Scenario arm_wall_contact: position/force control against a wall (thesis 2.4.3.2, 2.4.3.4).
#pragma once

#include <breakwater/rigs/arm_scenario.h>
#include <breakwater/rigs/wall_settings.h>

namespace breakwater {

/// The arm moves to its start pose. At `force.from_s` it begins to approach the wall, and then
/// presses on it with `force.reference_N`. The main metrics are impact force and free-motion time.
class ArmWallContact final : public ArmScenario {
 public:
  explicit ArmWallContact(const Catalogue& catalogue);

  std::string name() const override { return "arm_wall_contact"; }
  std::string summary() const override {
    return "hybrid position/force control against a wall: impact force, free-motion time";
  }
  Fields fields() override;
  void check(const Config& config) override;
  Recording run(const RunControl& control) const override;
  void prepare_scene(Model& model) const override;
  void animate_scene(Model& model, double time_s) const override;

 private:
  ArmTask task() const override;
  double wall_x_m() const { return start_pose()[0] + wall_distance_m_; }

  double wall_distance_m_ = 0.0;
  double wall_solid_from_s_ = 0.0;
  WallSettings wall_;
  double force_from_s_ = 0.0;
  double force_reference_N_ = 0.0;
  double convert_gain_per_m_ = 0.0;
  double metrics_from_s_ = 0.0;
  double metrics_to_s_ = 0.0;
  double fine_from_s_ = 0.0;
  double fine_to_s_ = 0.0;
};

}  // namespace breakwater
