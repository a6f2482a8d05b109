// The quadrotor under waves with its simulation, shared by its scenarios.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/rigs/quadrotor_parts.h>
#include <breakwater/sim/simulation.h>
#include <breakwater/sim/underwater_force.h>

namespace breakwater {

/// The keys of all scenarios with the quadrotor.
struct QuadrotorSettings {
  enum class NoiseInterpretation { variance, standard_deviation };

  explicit QuadrotorSettings(const Catalogue& catalogue) : parts(catalogue) {}

  ModelFile mjcf;
  QuadrotorParameters parameters;  ///< Table 3.4, without added mass
  QuadrotorPhysics physics_kind = QuadrotorPhysics::physical;
  PhysicsSettings physics;
  RunSettings run;
  std::optional<double> added_mass_coefficient;  ///< none in runs of earlier versions: 0
  std::vector<double> start_m;
  std::vector<double> reference_m;
  WaveLoadSetup waves;
  std::optional<double> inertia_coefficient;
  std::vector<double> current_m_s;
  double V_m = 0.0;
  double V_p = 0.0;
  NoiseInterpretation interpretation = NoiseInterpretation::standard_deviation;
  FaultSettings faults;
  QuadrotorParts parts;

  void bind(Fields& fields);

  /// The parameters with the added mass of the physical plant.
  QuadrotorParameters vehicle() const;
  QuadrotorModel plant() const { return {vehicle(), physics_kind}; }
  /// The task and nominal model for estimator and controller.
  QuadrotorTask task() const;
  /// The water's force on a model with the free body "quadrotor".
  UnderwaterForce water(const Model& model) const;
  /// A line if the model's mass is not that of the parameters.
  std::vector<std::string> warnings() const;
};

/// Checks what the single fields cannot: sizes, depths, periods, the parts of the model, the design
/// of estimator and controller. Throws std::invalid_argument `ORIGIN: KEY: reason`.
void check_quadrotor(const QuadrotorSettings& settings, const Config& config);

/// The true values at a sample.
struct QuadrotorTruth {
  Eigen::Matrix<double, 12, 1> motion = Eigen::Matrix<double, 12, 1>::Zero();  ///< ζ and its rate
  Eigen::Vector3d wave_force = Eigen::Vector3d::Zero();                        ///< in the world [N]
  Eigen::Vector3d wave_torque = Eigen::Vector3d::Zero();                       ///< [N m]
  Eigen::Vector3d error = Eigen::Vector3d::Zero();  ///< reference minus position [m]
  double elevation_m = 0.0;                         ///< elevation of the surface above the vehicle
  double saturated = 0.0;                           ///< 1 if a thrust is at its limit
};

/// The quadrotor with waves, estimator, controller and simulation, and its true values for the log.
///
/// The model must have a free body "quadrotor" with the sites t1 … t4, four thrusters and the
/// sensors position and attitude.
class QuadrotorRig {
 public:
  /// Throws std::invalid_argument if the model lacks something.
  explicit QuadrotorRig(const QuadrotorSettings& settings);
  QuadrotorRig(const QuadrotorRig&) = delete;
  QuadrotorRig& operator=(const QuadrotorRig&) = delete;

  /// One physics step, with the states of the waves at its beginning.
  void step();

  const Simulation& simulation() const { return simulation_; }
  const QuadrotorLoop& loop() const { return loop_; }

  /// The distance from the start to the reference.
  double distance_to_go_m() const { return (reference_ - start_).norm(); }

  /// Updates the true values from the last step of the simulation.
  void observe();
  const QuadrotorTruth& truth() const { return truth_; }

  /// The signals of the log at the control rate: true, measured, estimated and commanded.
  std::vector<Signal> signals() const;

 private:
  Eigen::Vector3d start_;
  Eigen::Vector3d reference_;
  QuadrotorLoop loop_;
  Simulation simulation_;
  UnderwaterForce waves_;
  QuadrotorTruth truth_;
};

}  // namespace breakwater
