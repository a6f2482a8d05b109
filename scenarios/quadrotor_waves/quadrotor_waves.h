// Scenario quadrotor_waves: a quadrotor holds station under waves (thesis 3.4).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <breakwater/control/backstepping.h>
#include <breakwater/scenario/scenario.h>
#include <breakwater/sim/underwater_force.h>

namespace breakwater {

/// A buoyant quadrotor goes to a point 10 m under waves and stays there, by backstepping control
/// that is fed by one of several nonlinear estimators.
class QuadrotorWaves final : public Scenario {
 public:
  std::string name() const override { return "quadrotor_waves"; }
  std::string summary() const override {
    return "underwater quadrotor under JONSWAP waves: nonlinear estimators, backstepping";
  }
  Fields fields() override;
  void check(const Config& config) override;
  const RunSettings& run_settings() const override { return run_; }
  std::vector<std::string> warnings() const override;
  Recording run(const RunControl& control) const override;
  void animate_scene(Model& model, double time_s) const override;

 private:
  enum class Gains { retuned, dlqr, printed };
  enum class NoiseInterpretation { variance, standard_deviation };
  enum class WaveFrequencySource { given, estimated };
  enum class MeasurementCovariance { printed, actual };

  // V as a standard deviation.
  double deviation(double V) const;
  QuadrotorModel plant() const { return {parameters_, physics_kind_}; }
  Backstepping law() const;
  QuadrotorEstimatorDesign estimator_design() const;
  WaveLoadSetup wave_setup() const;
  SensingSetup sensing_setup() const;

  RunSettings run_;
  PhysicsSettings physics_;
  FaultSettings faults_;
  std::string mjcf_;
  QuadrotorParameters parameters_;  // Table 3.4
  QuadrotorPhysics physics_kind_ = QuadrotorPhysics::physical;
  std::vector<double> start_m_;
  std::vector<double> reference_m_;
  WaveLoadSetup waves_;
  std::vector<double> current_m_s_;
  double V_m_ = 0.0;
  double V_p_ = 0.0;
  NoiseInterpretation interpretation_ = NoiseInterpretation::standard_deviation;
  QuadrotorEstimatorDesign estimator_;
  MeasurementCovariance covariance_ = MeasurementCovariance::actual;
  WaveFrequencySource frequency_source_ = WaveFrequencySource::given;
  double assumed_period_s_ = 0.0;
  Gains gains_ = Gains::retuned;
  bool compensates_ = true;
  double position_clamp_m_ = 0.0;
  double thrust_floor_N_ = 0.5;
  double window_s_ = 0.0;
  std::optional<UnderwaterForce> sea_;  // for pictures; once read
};

}  // namespace breakwater
