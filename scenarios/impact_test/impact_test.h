// Scenario impact_test: a mass on a rail strikes a wall.
#pragma once

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/force_sensor_settings.h>
#include <breakwater/rigs/wall_settings.h>

namespace breakwater {

/// A free mass strikes the wall at a given speed. There is no controller, so the impact depends on
/// the contact law, the wall and the force sensor alone.
class ImpactTest final : public Scenario {
 public:
  explicit ImpactTest(const Catalogue& catalogue)
      : Scenario(MetricRows(catalogue, "impact_test")), wall_(catalogue) {}

  std::string name() const override { return "impact_test"; }
  std::string summary() const override {
    return "a mass on a rail strikes a wall: contact laws, wall motion, force sensor";
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return run_; }
  Recording run(const RunControl& control) const override;
  void prepare_scene(Model& model) const override;
  void animate_scene(Model& model, double time_s) const override;

 private:
  Model plant() const;
  double wall_x_m(const Model& model) const;
  SensingSetup sensing() const;

  ModelFile mjcf_;
  PhysicsSettings physics_;
  RunSettings run_;
  WallSettings wall_;
  ForceSensorSettings force_sensor_;
  double mass_kg_ = 0.0;
  double speed_m_s_ = 0.0;
  double distance_m_ = 0.0;
  double push_N_ = 0.0;
  double fine_from_s_ = 0.0;
  double fine_to_s_ = 0.0;
};

}  // namespace breakwater
