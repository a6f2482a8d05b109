// Forecasts of the wave force from the sea itself, which no estimator of the vehicle knows.
#pragma once

#include <Eigen/Core>

#include <breakwater/control/force_forecast.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include <breakwater/sim/underwater_force.h>
#include <breakwater/world/noise.h>

namespace breakwater {

/// The true future of the wave force at the estimated position and velocity: the floor of all
/// forecasts. No vehicle can know it.
class ToldForecast final : public ForceForecast {
 public:
  /// Throws std::invalid_argument unless the waves are physical.
  ToldForecast(const QuadrotorTask& task, double period_s);

  void update(double time_s, const QuadrotorEstimator& estimator, ForceTable& forces) override;

 private:
  QuadrotorParameters vehicle_;
  WaveLoadSetup setup_;
  ChangingSea sea_;
  double period_s_;
};

struct UpstreamDesign {
  double distance_m = 30.0;  ///< from the probe to the reference, along the heading
  double noise_m = 0.02;     ///< standard deviation of the probe's noise
  double window_s = 60.0;    ///< length of the record
  double period_s = 0.1;     ///< T, also of the probe
};

/// A deterministic prediction of the waves from a probe upstream. Regularised least squares on the
/// last samples of the elevation give amplitude and phase of 40 components, in equal bands of 0.5 …
/// 3 ω_p:
///     η(t + τ) = Σ a_i cos ω_i τ + b_i sin ω_i τ,   τ ≤ 0,
/// with the standard deviations of a JONSWAP sea of 1 m as weights of a_i and b_i. Airy's
/// kinematics carry them to the vehicle. Morison's equation gives the force. The rest of the
/// estimated force, after a low-pass of 30 s, is added as a constant. The sea's period, γ, depth
/// and heading are known. The probe has measured for one window before the run.
///
/// Source of the idea: K. L. Walker, F. Giorgio-Serchi, Int. J. Robotics Research (2024),
/// doi 10.1177/02783649241286909. docs/explanation/methods/published-wave-control.md says what
/// differs.
class UpstreamForecast final : public ForceForecast {
 public:
  /// Throws std::invalid_argument unless the waves are physical and the numbers positive.
  UpstreamForecast(const QuadrotorTask& task, const UpstreamDesign& design);

  void reset(double time_s) override;
  void update(double time_s, const QuadrotorEstimator& estimator, ForceTable& forces) override;

 private:
  double measured(double time_s) const;

  QuadrotorParameters vehicle_;
  WaveLoadSetup setup_;
  UpstreamDesign design_;
  ChangingSea sea_;
  Noise noise_;
  Eigen::Vector2d probe_m_;
  Waves fitted_;            // seen from the present time
  Eigen::MatrixXd fit_;     // record → [a; b]
  Eigen::VectorXd record_;  // the newest sample first
  Eigen::VectorXd parts_;   // [a; b]
  Eigen::Vector3d constant_ = Eigen::Vector3d::Zero();
};

}  // namespace breakwater
