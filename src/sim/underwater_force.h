// Buoyancy, drag and waves on the quadrotor.
#pragma once

#include <array>
#include <optional>
#include <string>

#include <breakwater/plants/quadrotor.h>
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/surface_waves.h>
#include <breakwater/world/low_pass.h>
#include <breakwater/world/waves.h>

namespace breakwater {

enum class WaveMode {
  physical,  ///< Morison's force of the water's motion around the vehicle
  thesis     ///< one scalar force along the body's z axis, torques by atan2
};

struct WaveLoadSetup {
  WaveMode mode = WaveMode::physical;
  SeaState sea;
  Eigen::Vector3d current_m_s = Eigen::Vector3d::Zero();  ///< steady, everywhere; physical only
  double inertia_coefficient = 1.5;                       ///< C_m
  double buoyancy_arm_m = 0.05;          ///< z_B: where the waves' pressure acts, above the mass
  double low_pass_s = 0.32;              ///< of slope or angle, before it makes a torque
  double torque_per_angle_Nm_rad = 0.1;  ///< thesis
  double change_at_s = 0.0;              ///< 0: never; else the sea's peak period changes then …
  double change_to_period_s = 0.0;       ///< … to this one, …
  double change_within_s = 10.0;         ///< … over this time
};

/// A rigid body's motion as the engine's free joint has it.
struct FreeMotion {
  FreeMotion(const double* qpos, const double* qvel);
  Eigen::Vector3d position;
  Eigen::Vector3d velocity;    ///< in the world
  Eigen::Vector3d body_rates;  ///< in the body
  Eigen::Matrix3d rotation;    ///< body to world
  Eigen::Vector3d euler;       ///< roll, pitch, yaw
};

/// What acts on the quadrotor besides thrust and the engine's gravity: the rest of Eq. 3.15, and F.
///
/// Waves, physical: with u the water's velocity at the vehicle and a its acceleration,
///     F = ρ V C_m a + D(v) − D(v − u),   τ = z_B e_z × (−ρ g V s),
/// so that with the drag −D(v) in still water the drag is that of the relative velocity; s is the
/// low-passed slope of the pressure.
///
/// Waves, thesis (3.4.1.2): d_z = ρ V C_m a_z at the start, F = d_z e_z and
///     τ_φ = K LP(atan2(F_y, F_z)),   τ_θ = K LP(atan2(F_x, F_z)),
/// where e_z is the body's z axis. The angle jumps by π whenever d_z changes its sign. Its low-pass
/// is a state, which advance() moves on once a step.
///
/// Drag −D acts on the velocity in the world's axes, and on the body's rates.
class UnderwaterForce final : public ExternalForce {
 public:
  /// The model needs a free body "quadrotor". `start` is where the thesis' scalar wave is taken.
  /// Throws std::invalid_argument if it has none, or the sea is nonsense.
  UnderwaterForce(const Model& model, const QuadrotorParameters& parameters,
                  QuadrotorPhysics physics, const WaveLoadSetup& waves,
                  const Eigen::Vector3d& start);

  void apply(double time_s, const mjModel& model, mjData& data) const override;

  /// Force and torque of the waves, current included, in the world's axes [N, N m].
  Vector6d wave_load(double time_s, const FreeMotion& motion) const;
  /// η at a place [m].
  double elevation(double time_s, double x_m, double y_m) const;
  /// The waves that η is the sum of.
  std::vector<SurfaceWave> surface_waves() const;

  /// To be called once after each step, with the state at its end.
  void advance(double time_s, const FreeMotion& motion);

 private:
  WaterMotion water(double time_s, const Eigen::Vector3d& position) const;
  double thesis_force(double time_s) const;
  // How much of the changed sea there is at that time, 0 … 1.
  double changed(double time_s) const;

  QuadrotorParameters parameters_;
  QuadrotorModel still_water_;
  WaveLoadSetup setup_;
  Eigen::Vector3d start_;
  Waves waves_;
  std::optional<Waves> changed_waves_;
  std::array<LowPass, 2> angle_;
  int body_;
  int qpos_;
  int dof_;
};

}  // namespace breakwater
