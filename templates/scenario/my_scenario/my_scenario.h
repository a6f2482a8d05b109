// Scenario my_scenario: any estimator and controller of an axis hold a pendulum against gravity.
#pragma once

#include <string>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/sim/simulation.h>

namespace my_scenario_lab {

/// A pendulum on a motor, J q̈ = u − d − c q̇. The disturbance d is unknown to estimator and
/// controller: gravity, m g l sin q, and a push. The motor turns the pendulum from hanging to a
/// reference angle; then a push disturbs it. How well is it held, and d estimated?
class MyScenario final : public breakwater::Scenario {
 public:
  explicit MyScenario(const breakwater::Catalogue& catalogue)
      : Scenario(breakwater::MetricRows(catalogue, "my_scenario")), parts_(catalogue, "pd") {}

  std::string name() const override { return "my_scenario"; }
  std::string summary() const override { return "a pendulum, held against gravity and a push"; }
  breakwater::Fields fields() override;
  void check(const breakwater::Config& config) override;
  const breakwater::RunSettings& run_settings() const override { return run_; }
  breakwater::Recording run(const breakwater::RunControl& control) const override;

 private:
  breakwater::Model plant() const;
  breakwater::SensingSetup sensing() const;
  breakwater::AxisTask task() const;
  double hold_torque_Nm(const breakwater::Model& model) const;

  // The plant.
  breakwater::ModelFile mjcf_;
  double mass_ratio_ = 1.0;
  double friction_Nms_rad_ = 0.0;
  double resolution_rad_ = 0.0;
  // The experiment.
  breakwater::PhysicsSettings physics_;
  breakwater::RunSettings run_;
  breakwater::Reference reference_;
  breakwater::Disturbance push_;
  // The estimator and controller, and their nominal model.
  breakwater::AxisParts parts_;
  double nominal_inertia_kgm2_ = 0.0;
  // Keys for the metrics' rows.
  double from_s_ = 0.0;
  double to_s_ = 0.0;
  double settled_within_rad_ = 0.0;
};

/// The scenario for the catalogue: its name, the function that makes it, and its folder.
breakwater::ScenarioKind my_scenario_kind();

}  // namespace my_scenario_lab
