// Scenario quadrotor_waves: a quadrotor holds station under waves (thesis 3.4).
#pragma once

#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include <breakwater/sim/underwater_force.h>

namespace breakwater {

/// A buoyant quadrotor goes to a point 10 m under waves and stays there, by backstepping control
/// that is fed by one of several nonlinear estimators.
class QuadrotorWaves final : public Scenario {
 public:
  explicit QuadrotorWaves(const Catalogue& catalogue) : parts_(catalogue) {}

  std::string name() const override { return "quadrotor_waves"; }
  std::string summary() const override {
    return "underwater quadrotor under JONSWAP waves: nonlinear estimators, backstepping";
  }
  std::vector<std::string> main_metrics() const override {
    return {"tracking_rmse_m", "position_estimate_rmse_m"};
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return run_; }
  std::vector<std::string> warnings() const override;
  Recording run(const RunControl& control) const override;
  std::vector<WavingSurface> waving_surfaces(const Model& model) const override;

 private:
  enum class NoiseInterpretation { variance, standard_deviation };

  // V as a standard deviation.
  double deviation(double V) const;
  QuadrotorModel plant() const { return {parameters_, physics_kind_}; }
  QuadrotorTask task() const;
  UnderwaterForce water(const Model& model) const;
  WaveLoadSetup wave_setup() const;
  SensingSetup sensing_setup() const;

  RunSettings run_;
  PhysicsSettings physics_;
  FaultSettings faults_;
  ModelFile mjcf_;
  QuadrotorParameters parameters_;  // Table 3.4
  QuadrotorPhysics physics_kind_ = QuadrotorPhysics::physical;
  std::vector<double> start_m_;
  std::vector<double> reference_m_;
  WaveLoadSetup waves_;
  std::vector<double> current_m_s_;
  double V_m_ = 0.0;
  double V_p_ = 0.0;
  NoiseInterpretation interpretation_ = NoiseInterpretation::standard_deviation;
  QuadrotorParts parts_;
  double window_s_ = 0.0;
};

}  // namespace breakwater
