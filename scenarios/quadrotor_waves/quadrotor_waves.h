// Scenario quadrotor_waves: a quadrotor holds station under waves (thesis 3.4).
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/quadrotor_rig.h>

namespace breakwater {

/// A buoyant quadrotor goes to a point 10 m under waves and stays there. Its backstepping control
/// uses the state of one of several nonlinear estimators.
class QuadrotorWaves final : public Scenario {
 public:
  explicit QuadrotorWaves(const Catalogue& catalogue);

  std::string name() const override { return "quadrotor_waves"; }
  std::string summary() const override {
    return "underwater quadrotor under JONSWAP waves: nonlinear estimators, backstepping";
  }
  std::vector<MetricDefinition> metric_definitions() const override;
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return quadrotor_.run; }
  std::vector<std::string> warnings() const override;
  Recording run(const RunControl& control) const override;
  std::vector<WavingSurface> waving_surfaces(const Model& model) const override;

 private:
  QuadrotorSettings quadrotor_;
  double window_s_ = 0.0;
};

}  // namespace breakwater
